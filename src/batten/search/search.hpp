#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The fewest control points with which every sample is within its tolerance: a curve (open or
/// closed) through a sequence, where a sample's distance is that of a point of the curve that also
/// keeps the samples' order; a surface or volume over a grid or cloud, where it is that of the
/// point at its own parameters (for heights the height difference).
///
/// Not reaching the tolerance is no error: the report's termination is tolerance_not_met, the
/// verdict says why, and the spline is the best smooth one found. More than nine tenths of a
/// curve's samples become control points only on the knots of the curve through all of them, which
/// is tried last.
Fitted fit_by_search(const Problem& problem, std::string_view method);

/// The two of which it takes the one for the problem's kind.
Fitted curve_within(const Problem& problem);
Fitted surface_within(const Problem& problem);

inline constexpr double most_part = 0.9;   ///< of the samples may become control points
inline constexpr double smooth_part = 0.5; ///< beyond it a fit is near-interpolation
inline constexpr Index few_samples = 5000; ///< searching once more takes little time
/// Whether there are so many control points that a spline follows each sample.
inline bool near_interpolation(Index control_points, Index samples) {
    return static_cast<double>(control_points) > smooth_part * static_cast<double>(samples);
}

/// Part of what is allowed between samples beyond which a spline is no reading of them.
inline constexpr double wild_part = 3;
/// Part of the samples' size that is allowed between them as if it were the tolerance: a tighter
/// one says nothing of what lies there.
inline constexpr double unseen = 1e-4;

} // namespace batten
