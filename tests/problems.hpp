#pragma once

#include "reference.hpp"

#include <batten/batten.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <iostream>
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

/// Path of a file of the shared test data.
inline std::string shared(const std::string& name) {
    return std::string(BATTEN_SHARED_DATA) + "/" + name;
}

} // namespace batten::testing

/// Ends a test whose shared data are absent: failed where CI is set, else named as not run.
#define BATTEN_NEEDS_SHARED(file)                                                                  \
    if (!std::filesystem::exists(batten::testing::shared(file))) {                                 \
        if (std::getenv("CI") != nullptr) FAIL() << "shared data absent: " << (file);              \
        std::cout << "NOT RUN: " << test_info_->test_suite_name() << '.' << test_info_->name()     \
                  << ": shared data absent: " << (file) << std::endl;                              \
        GTEST_SKIP();                                                                              \
    }
