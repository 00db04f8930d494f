#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Fits a B-spline with a stated number of control points (or stated knots) to the samples by least
/// squares.
///
/// A sequence gives a curve, a grid a surface or volume. Throws InvalidInput for samples and
/// options that break a rule or, with the direct solver, leave control points undetermined;
/// Cancelled when asked to stop.
FitResult fit(const Samples& samples, const FitOptions& options = {});

} // namespace batten
