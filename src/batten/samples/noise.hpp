#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// The value in the middle, 0 of none; of an even number the upper of the two.
double median(std::vector<double> values);

/// What third differences leave room for as noise of a sequence: its standard deviation, of the
/// whole vector, where the samples are dense; more than that where they are coarse.
double noise_bound(const Points& sequence);

/// The same by the median of the third differences: gaps and corners do not count.
double usual_noise(const Points& sequence);

/// The least of these over the axes of a sequence or a grid of that shape, where it is white noise:
/// neighbouring third differences are as anticorrelated as its own along every axis; else 0.
double white_noise(const Points& samples, const std::vector<Index>& shape);

} // namespace batten
