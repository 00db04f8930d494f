#pragma once

#include <batten/samples/samples.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace batten::command {

/// The 20 points of the helix in example 1 of [LinWangDong2004].
inline Samples paper_helix() {
    PointSet q(20, 3);
    for (Index i = 0; i < 20; ++i) {
        const double t = 8 * std::numbers::pi * static_cast<double>(i) / 19;
        q(i, 0) = 6 * std::cos(t);
        q(i, 1) = 6 * std::sin(t);
        q(i, 2) = 2 * t;
    }
    Samples samples;
    samples.points = Points(std::move(q));
    return samples;
}

/// In place of its Fig. 5: a convex polygon of 12 points at random angles of an ellipse; of such
/// polygons plain PIA loses the convexity of about half.
inline Samples convex_polygon(unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> step(0.05, 1);
    std::vector<double> angle{0};
    for (int i = 0; i < 11; ++i) angle.push_back(angle.back() + step(random));
    PointSet q(12, 2);
    for (Index i = 0; i < 12; ++i) {
        const double a = angle[static_cast<std::size_t>(i)] / angle.back() * 1.8 * std::numbers::pi;
        q(i, 0) = 3 * std::cos(a);
        q(i, 1) = std::sin(a);
    }
    Samples samples;
    samples.points = Points(std::move(q));
    return samples;
}

} // namespace batten::command
