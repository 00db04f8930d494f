#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// The value in the middle, 0 of none; of an even number the upper of the two.
double median(std::vector<double> values);

/// Standard deviation of the noise of a sequence, from third differences: of the whole vector, all
/// coordinates together. Overestimates where the sampling is coarse.
double noise_level(const Points& sequence);

/// The same from the median of the third differences: gaps and corners do not count.
double usual_noise(const Points& sequence);

} // namespace batten
