#pragma once

#include <array>

namespace batten {

inline constexpr int lanes = 8;

/// Eight partial sums, one per lane: sums in fixed lanes give the same bits on every vector unit.
struct alignas(64) Lanes {
    std::array<double, lanes> value{};
    double sum() const {
        const auto& v = value;
        return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
    }
};

} // namespace batten
