# Flags that every target of this project is built with, as one interface target.
add_library(batten_flags INTERFACE)
target_compile_features(batten_flags INTERFACE cxx_std_20)
target_compile_options(batten_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
                                              $<$<BOOL:${BATTEN_WERROR}>:-Werror>)
if(BATTEN_SANITIZE)
  target_compile_options(batten_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # not position independent: 1.6 million addresses of the checks' tables would be relocated at every start
  target_link_options(batten_flags INTERFACE -fsanitize=address,undefined -no-pie)
endif()
if(BATTEN_FUZZ)
  target_compile_options(batten_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(BATTEN_SANITIZE_THREADS)
  target_compile_options(batten_flags INTERFACE -fsanitize=thread)
  target_link_options(batten_flags INTERFACE -fsanitize=thread)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
