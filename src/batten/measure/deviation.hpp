#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>

namespace batten {

/// What the deviation of a sample is measured against.
enum class DeviationKind {
    parametric, ///< the spline's point at the sample's own parameter
    distance,   ///< the spline's closest point
};

std::string_view to_string(DeviationKind kind);

/// How far samples lie from a spline.
struct Deviation {
    double maximum = 0;
    double rms = 0;
    Index worst_sample = 0;
    DeviationKind kind = DeviationKind::parametric;
};

/// One deviation per sample, each at its own parameter.
std::vector<double> parametric_deviations(const Spline& spline, const Samples& samples,
                                          const Parameters& parameters);

/// Maximum, its first sample and root mean square of the given deviations.
Deviation summarise(const std::vector<double>& deviations, DeviationKind kind);

/// A spline's closest point to something.
struct ClosestPoint {
    std::vector<double> parameter; ///< one per axis
    double distance = 0;
};

/// Closest points of a curve or surface to the points: a coarse search over the pieces refined by
/// Newton's method [PieglTiller1997, section 6.1]. Throws InvalidInput for dimensions that differ,
/// or a volume.
std::vector<ClosestPoint> closest_points(const Spline& spline, const Points& points);

} // namespace batten
