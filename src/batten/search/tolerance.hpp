#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Fits a curve (open or closed) to a sequence, or a surface or volume to a grid or a cloud with
/// given parameters, with as few control points as it can so that every sample is within its
/// tolerance: for curves of a point of the curve that also keeps the samples' order, for grids of
/// the point at its own parameters (for heights the height difference).
///
/// Not reaching the tolerance is no error: the report's termination is tolerance_not_met, the
/// verdict says why, and the spline is the closest one found that is not wild between samples, or
/// the best smooth one where the samples' noise is known and too much. More than nine tenths of the
/// samples are never used as control points. Throws InvalidInput for a tolerance that is not
/// positive.
FitResult fit_to_tolerance(const Samples& samples, const FitOptions& options);

/// One tolerance per sample. Throws InvalidInput unless there is one for each, positive and finite.
std::vector<double> sample_tolerances(const Samples& samples, const ToleranceOptions& options);

} // namespace batten
