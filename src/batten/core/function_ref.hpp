#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace batten {

template <class Signature>
class FunctionRef;

/// A callable to be called while it lives: what a virtual function takes in place of a template
/// parameter, without the allocation that an owning wrapper may need.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
  public:
    template <class Callable>
    requires(!std::is_same_v<std::remove_cvref_t<Callable>, FunctionRef>) FunctionRef(
        Callable&& callable) // NOLINT(google-explicit-constructor): given where it is asked
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
          call_([](void* object, Arguments... arguments) -> Result {
              return (*static_cast<std::remove_reference_t<Callable>*>(object))(
                  std::forward<Arguments>(arguments)...);
          }) {}

    Result operator()(Arguments... arguments) const {
        return call_(object_, std::forward<Arguments>(arguments)...);
    }

  private:
    void* object_;
    Result (*call_)(void*, Arguments...);
};

} // namespace batten
