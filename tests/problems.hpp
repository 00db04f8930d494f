#pragma once

#include <batten/batten.hpp>

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <string>

namespace batten::testing {

/// The message of the exception of type Error that `work` must throw.
template <class Error>
std::string message_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

/// (m x dim) numbers uniform in [-1, 1], from a fixed seed.
inline PointSet random_points(Index count, Index dim, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    PointSet points(count, dim);
    for (double& x : points.values()) x = value(random);
    return points;
}

/// Ascending parameters in [0, 1], ends included, from a fixed seed.
inline std::vector<double> random_parameters(Index count, unsigned seed) {
    std::vector<double> t = random_points(count, 1, seed).values();
    for (double& x : t) x = (x + 1) / 2;
    std::sort(t.begin(), t.end());
    t.front() = 0;
    t.back() = 1;
    return t;
}

/// A curve's samples.
inline Samples sequence(PointSet points) {
    Samples samples;
    samples.points = Points(std::move(points));
    return samples;
}

/// Largest difference of two sets of one shape.
inline double largest_difference(const PointSet& a, const PointSet& b) {
    EXPECT_EQ(a.values().size(), b.values().size());
    double largest = 0;
    for (std::size_t k = 0; k < a.values().size(); ++k)
        largest = std::max(largest, std::abs(a.values()[k] - b.values()[k]));
    return largest;
}

/// Dense entry of the collocation matrix of one axis, from the definition of the B-splines alone.
inline double basis_by_recursion(const KnotVector& k, Index i, int p, double t) {
    if (p == 0)
        return (t >= k[i] && t < k[i + 1]) || (t == k.end() && t == k[i + 1] && k[i] < k[i + 1])
                   ? 1.0
                   : 0.0;
    double sum = 0;
    if (k[i + p] > k[i]) sum += (t - k[i]) / (k[i + p] - k[i]) * basis_by_recursion(k, i, p - 1, t);
    if (k[i + p + 1] > k[i + 1])
        sum +=
            (k[i + p + 1] - t) / (k[i + p + 1] - k[i + 1]) * basis_by_recursion(k, i + 1, p - 1, t);
    return sum;
}

} // namespace batten::testing
