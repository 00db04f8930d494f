# Flags that every target of this project is built with, as one interface target.
add_library(batten_flags INTERFACE)
target_compile_features(batten_flags INTERFACE cxx_std_20)
target_compile_options(batten_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
                                              $<$<BOOL:${BATTEN_WERROR}>:-Werror>)
if(BATTEN_SANITIZE)
  target_compile_options(batten_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(batten_flags INTERFACE -fsanitize=address,undefined)
endif()
if(BATTEN_SANITIZE_THREADS)
  target_compile_options(batten_flags INTERFACE -fsanitize=thread)
  target_link_options(batten_flags INTERFACE -fsanitize=thread)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
