#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/report.hpp>
#include <batten/system/constraints.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// Runs a method in the one loop from the free control points `control` (relative to nothing or to
/// the system's centre, as the method takes them), with the options' observer, history and shape
/// limit, and enters how it went in the report. `deviation` measures the largest deviation of a
/// sample from absolute control points; `centre` is what `control` is relative to, nothing when
/// empty.
void run(Method& method, PointSet& control, const FitOptions& options,
         const std::vector<KnotVector>& axes, const DeviationMeasure& deviation, FitReport& report,
         const std::vector<double>& centre = {});

/// Free control points (N x dim) of the least-squares fit by the report's method: direct, clspia or
/// an iteration on the normal equations.
PointSet least_squares(const std::vector<KnotVector>& axes, const Samples& samples,
                       const Parameters& parameters, const Constraints& constraints,
                       const FitOptions& options, FitReport& report);

/// The step limit that keeps what the options want kept, none for nothing.
/// Throws InvalidInput unless the spline is a planar curve, or convexity is asked of a polygon that
/// is not convex.
StepLimit shape_limit(Preserve preserve, const std::vector<KnotVector>& axes,
                      const PointSet& control, std::string_view method);

} // namespace batten
