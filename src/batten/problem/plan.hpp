#pragma once

#include <batten/problem/options.hpp>
#include <batten/system/sample_groups.hpp>

namespace batten {

/// Options spread over the axes of given samples: one entry per axis each.
struct AxisPlan {
    std::vector<int> degree;
    std::vector<Index> control_points;
    std::vector<Closure> closures;
};

/// Throws InvalidInput when the options' lists do not fit the number of axes, or no size is given.
AxisPlan plan_axes(const Samples& samples, const ShapeOptions& options);

/// The options' degree for each of `axes` axes; throws InvalidInput when their number does not fit.
std::vector<int> degrees_per_axis(const ShapeOptions& options, Index axes);

/// The parameters that the options give or rule. Closed axes have period 1.
Parameters choose_parameters(const Samples& samples, const ShapeOptions& options,
                             const AxisPlan& plan);

/// The knots that the options give or rule, per axis; names the axis in what it throws.
std::vector<KnotVector> choose_knots(const Parameters& parameters, const ShapeOptions& options,
                                     const AxisPlan& plan);

/// Control points per axis when smoothing rules the detail and their number does not: enough to
/// follow the samples.
std::vector<Index> smoothing_size(const Samples& samples, const ShapeOptions& shape);

/// Groups of a cloud's samples: each belongs to the control point whose Greville abscissae are
/// nearest.
SampleGroups nearest_groups(const Parameters& parameters, const std::vector<KnotVector>& axes);

/// Free control points (N x dim) to start from.
PointSet initial_control(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, const MethodOptions& options);

} // namespace batten
