#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>

namespace batten {

/// Distance of every sample of a sequence from the curve's point at its ascending parameter, span
/// by span: each polynomial piece is evaluated from its Chebyshev coefficients, relative to the
/// first control point so that large offsets keep their detail.
std::vector<double> curve_deviations(const Spline& curve, const Points& points,
                                     std::span<const double> parameters);

/// The same of points (count x dim) one after the other into `out`, one for each parameter.
void curve_deviations(const Spline& curve, const double* points, std::span<const double> parameters,
                      double* out);

} // namespace batten
