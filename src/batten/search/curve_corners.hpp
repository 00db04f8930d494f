#pragma once

#include <batten/search/curve_trial.hpp>

#include <vector>

namespace batten {

/// Without the corners that have too few samples between them and the one before, or an end: a
/// piece of the curve of its own needs degree + 1.
std::vector<Index> spaced_corners(const std::vector<Index>& corners, const CurveTask& task);

/// The caller's corners, ascending, without the ends of an open curve. Throws InvalidInput for one
/// that is no sample, or with too few samples beside it.
std::vector<Index> checked_corners(std::vector<Index> corners, const CurveTask& task);

/// Corners, a seam that is held and samples with tangents: their parameters must stay.
std::vector<Index> fixed_samples(const CurveTask& task);

} // namespace batten
