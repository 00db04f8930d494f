#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// A third as many control points as a cloud has samples along each axis, evenly.
std::vector<KnotVector> robust_knots(const Problem& problem, const Parameters& parameters);

/// The robust fit to all samples of a cloud: the reach of Tukey's loss shrinks from the largest
/// residual to 4.685 times their scale, so that the farthest let go first and what they pulled
/// along falls back [HollandWelsch1977]. Residuals below a third of `least` are taken for exact.
Spline robust_spline(const Samples& samples, const Parameters& parameters,
                     const std::vector<KnotVector>& axes, double least);

} // namespace batten
