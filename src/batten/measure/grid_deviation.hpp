#pragma once

#include <batten/measure/deviation.hpp>

namespace batten {

/// Deviation of a grid's samples from the surface or volume at their parameters (ascending or not,
/// per axis), tile by tile of the slices along axis 0, relative to the first control point. Fills
/// `each`, one per sample, unless it is null.
Deviation grid_deviation(const Spline& spline, const Points& points,
                         const std::vector<std::vector<double>>& axes, double* each);

} // namespace batten
