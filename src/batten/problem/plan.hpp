#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// Throws InvalidInput when the options' lists do not fit the number of axes, a degree is outside
/// its range, or a stated number of control points is too small for its degree.
AxisPlan plan_axes(const ShapeOptions& options, Index axes);

/// The knots that a sized problem gives or rules, per axis, those of the boundaries among them.
/// Throws InvalidInput naming the axis.
std::vector<KnotVector> fixed_knots(const Problem& problem);

/// Control points per axis when smoothing rules the detail and their number does not: enough to
/// follow the samples, half as many as differ along the axis, at most as many as below.
std::vector<Index> smoothing_size(const Problem& problem);
Index most_smoothing_size(const Problem& problem);

/// Samples along an axis: of the grid, or evenly so many of a sequence or cloud.
double samples_along(const Problem& problem, std::size_t axis);

} // namespace batten
