#pragma once

#include <batten/core/lanes.hpp>

namespace batten {

/// One number per lane, as the compiler's own vector: for sources of kernels, compiled without the
/// warning that such a value is passed in other registers where the machine has wide ones.
typedef double LaneVector __attribute__((
    vector_size(64))); // NOLINT(modernize-use-using): GCC wants the attribute on a typedef

inline __attribute__((always_inline)) LaneVector load(const double* x) {
    LaneVector v;
    __builtin_memcpy(&v, x, sizeof v);
    return v;
}

inline __attribute__((always_inline)) void store(const LaneVector& v, double* x) {
    __builtin_memcpy(x, &v, sizeof v);
}

} // namespace batten
