#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/problem/problem.hpp>

#include <optional>

namespace batten {

/// Throws InvalidInput for a smoothing whose factor or order makes no sense for the axes' degrees.
void check_smoothing(const SmoothOptions& smooth, const AxisPlan& axes);

/// Throws InvalidInput when the options' lists do not fit the number of axes, a degree is outside
/// its range, or a stated number of control points is too small for its degree.
AxisPlan plan_axes(const ShapeOptions& options, Index axes);

/// The axes of samples of a kind and shape (per axis; -1 where it is not known) and dimension, once
/// everything that the options say of them is checked. Throws InvalidInput.
AxisPlan planned(const FitOptions& options, SampleKind kind, const std::vector<Index>& shape,
                 Index dim, Index axes);

/// Where an axis's parameters begin and end.
struct Extent {
    double begin;
    double end;
};

/// Free control points whose knots are placed, the seam's copies taken away.
Index placed_count(const FitOptions& options, const AxisPlan& plan, std::size_t axis);

/// The rule for knots where the options leave it open: that of the papers for their methods.
KnotPlacement placement_of(const FitOptions& options, SampleKind kind);

/// An axis's knots, given or ruled; `among` places the counted ones among the parameters that
/// differ, or says nothing where these are fewer.
KnotVector axis_knots(const FitOptions& options, const AxisPlan& plan, std::size_t axis,
                      KnotPlacement rule, const Extent& extent,
                      FunctionRef<std::optional<KnotVector>(Index)> among);

/// Whether as many of an axis's samples share a parameter as are in a span, so that knots placed
/// among them would meet.
bool knots_meet(Index longest_run, Index samples, Index n, int degree);

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
