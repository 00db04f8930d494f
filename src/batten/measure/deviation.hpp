#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>

#include <span>

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

/// One deviation per sample, of the given kind.
std::vector<double> deviations(const Spline& spline, const Samples& samples,
                               const Parameters& parameters, DeviationKind kind);

/// Sum of squares and maximum of some deviations.
struct DeviationPart {
    double squares = 0;
    double maximum = 0;
};
DeviationPart measured(std::span<const double> deviations);

/// Deviations that pass by in chunks, each measured beforehand, on whatever thread.
class DeviationSum {
  public:
    /// Of the deviations that follow those before.
    void add(const DeviationPart& part, std::span<const double> deviations);
    Deviation deviation(DeviationKind kind) const;

  private:
    Index count_ = 0;
    double squares_ = 0;
    double maximum_ = 0;
    Index worst_ = 0;
};

/// Maximum, its first sample and root mean square of the given deviations.
Deviation summarise(const std::vector<double>& deviations, DeviationKind kind);

/// A spline's closest point to something.
struct ClosestPoint {
    std::vector<double> parameter; ///< one per axis
    double distance = 0;
};

/// Closest points of a curve, surface or volume to the points (m x dim): the distance is the least
/// there is to 1e-12 of the spline's size, or of itself when that is larger. Throws InvalidInput
/// for dimensions that differ, a coordinate or a control point that is not finite.
std::vector<ClosestPoint> closest_points(const Spline& spline, const Points& points);

/// The same distances alone.
std::vector<double> closest_distances(const Spline& spline, const Points& points);

/// The same for samples whose parameters are near their closest points, as those of a fit are: the
/// faster the nearer, and as certain when they are not. Parameters are wrapped on closed axes,
/// moved to the end of open ones. Throws InvalidInput also when their number does not match.
std::vector<double> closest_distances(const Spline& spline, const Samples& samples,
                                      const Parameters& starts);

} // namespace batten
