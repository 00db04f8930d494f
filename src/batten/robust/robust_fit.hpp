#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// Parameters that samples far off do not stretch: medians over a grid's rows; those given, where
/// the options give them. Of a grid or a cloud.
Parameters robust_parameters(const Problem& problem);

/// Half as many control points as samples along each axis of a grid, a third of a cloud's, evenly
/// among them; the same from either end.
std::vector<KnotVector> robust_knots(const Problem& problem, const Parameters& parameters);

/// The robust fit to all samples: the reach of Tukey's loss shrinks from the largest residual to
/// 4.685 times their scale, so that the farthest let go first and what they pulled along falls
/// back [HollandWelsch1977]. Residuals below a third of `least` are taken for exact.
Spline robust_spline(const Samples& samples, const Parameters& parameters,
                     const std::vector<KnotVector>& axes, double least);

/// The spline's points at the samples' parameters.
PointSet fitted_values(const Spline& spline, const Parameters& parameters);

} // namespace batten
