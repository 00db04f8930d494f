#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/report.hpp>
#include <batten/shape/limits.hpp>

namespace batten {

/// How a method went: the control points it came to, and its part of the account.
struct Course {
    PointSet control; ///< free control points, relative to what the start was relative to
    FitReport report;
};

/// Where a method starts and what its control points are relative to.
struct Departure {
    PointSet control;             ///< free control points (N x dim)
    std::vector<double> centre{}; ///< empty: nothing
};

/// Runs a method in the one loop under the options' stop rule, observer, history and shape limit.
/// `deviation` measures the largest deviation of a sample from absolute control points. Throws
/// InvalidInput as check_shape does, and for settings of a limit that there is not.
Course iterated(Method& method, Departure start, const std::vector<KnotVector>& axes,
                const FitOptions& options, const DeviationMeasure& deviation);

/// Throws InvalidInput unless what is to be kept can be: of a planar curve, convexity of a convex
/// initial polygon (absolute); PIA keeps the turns of any [LinWangDong2004, section 1.3].
void check_shape(Preserve preserve, const std::vector<KnotVector>& axes, const PointSet& control,
                 std::string_view method);

} // namespace batten
