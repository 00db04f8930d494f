#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The two searches behind fit_to_tolerance, with one tolerance per sample.
FitResult curve_within(const Samples& samples, const FitOptions& options,
                       std::vector<double> tolerance);
FitResult surface_within(const Samples& samples, const FitOptions& options,
                         const std::vector<double>& tolerance);

inline constexpr double most_part = 0.9;   ///< of the samples may become control points
inline constexpr double smooth_part = 0.5; ///< beyond it a fit is near-interpolation
inline constexpr Index few_samples = 5000; ///< searching once more takes little time
/// Whether there are so many control points that a spline follows each sample.
inline bool near_interpolation(Index control_points, Index samples) {
    return static_cast<double>(control_points) > smooth_part * static_cast<double>(samples);
}

/// Part of what is allowed between samples beyond which a spline is no reading of them.
inline constexpr double wild_part = 3;

} // namespace batten
