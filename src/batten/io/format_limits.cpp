#include <batten/io/format_limits.hpp>

#include <fmt/format.h>

namespace batten {

void check(const FormatLimits& limits, Index axes, Index dim) {
    const bool drawn = dim == 1 && axes <= limits.most_variables;
    const bool fits = axes >= limits.least_axes && axes <= limits.most_axes &&
                      (drawn || (dim >= limits.least_dim && dim <= limits.most_dim));
    if (!fits)
        throw InvalidInput(fmt::format("{}, this spline has {} {} in dimension {}", limits.holds,
                                       axes, axes == 1 ? "axis" : "axes", dim));
}

} // namespace batten
