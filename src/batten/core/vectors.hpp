#pragma once

#include <batten/core/index.hpp>

#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

namespace batten {

/// Inner product of two vectors of one length, summed from the first entry on.
inline double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t d = 0; d < a.size(); ++d) sum += a[d] * b[d];
    return sum;
}

/// Euclidean length.
inline double norm(std::span<const double> a) {
    return std::sqrt(dot(a, a));
}

/// a - b.
inline std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
    std::vector<double> result(a.size());
    for (std::size_t d = 0; d < result.size(); ++d) result[d] = a[d] - b[d];
    return result;
}

/// x *= factor.
inline void scale(std::span<double> x, double factor) {
    for (double& value : x) value *= factor;
}

/// y += factor * x over `count` numbers, often as few as a point has: then their number is known to
/// the compiler.
inline void add_scaled(double* y, double factor, const double* x, Index count) {
    const auto add = [&](auto length) {
        for (Index k = 0; k < length; ++k) y[k] += factor * x[k];
    };
    switch (count) {
    case 1:
        return add(std::integral_constant<Index, 1>());
    case 2:
        return add(std::integral_constant<Index, 2>());
    case 3:
        return add(std::integral_constant<Index, 3>());
    default:
        return add(count);
    }
}

} // namespace batten
