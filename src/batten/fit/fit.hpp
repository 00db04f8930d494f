#pragma once

#include <batten/fit/options.hpp>
#include <batten/fit/report.hpp>

namespace batten {

/// A fitted spline and the account of it.
struct FitResult {
    Spline spline;
    FitReport report;
    Parameters parameters;
};

/// Fits a B-spline with a stated number of control points (or stated knots) to the samples by least
/// squares.
///
/// A sequence gives a curve, a grid a surface or volume. Throws InvalidInput for samples and
/// options that break a rule or, with the direct solver, leave control points undetermined;
/// Cancelled when asked to stop.
FitResult fit(const Samples& samples, const FitOptions& options = {});

} // namespace batten
