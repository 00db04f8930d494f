#pragma once

#include <batten/problem/options.hpp>

#include <string>
#include <vector>

namespace batten {

class PointScan;

/// The options spread over the axes: one entry per axis each.
struct AxisPlan {
    std::vector<int> degree;
    /// Stated free control points; empty where the driver finds them or knots are given.
    std::vector<Index> control_points;
    std::vector<Closure> closures;

    std::size_t count() const { return degree.size(); }
};

/// A fit as it was asked for, checked and completed once: all that a driver works from.
struct Problem {
    Samples samples;
    SampleKind kind = SampleKind::sequence;
    /// Every choice that the samples decide is made in them.
    FitOptions options{};
    AxisPlan axes{};
    Parameters parameters{};
    /// One per sample where a tolerance is stated, else empty; infinite: the sample may be
    /// anywhere.
    std::vector<double> tolerance{};
    /// Diagonal of the samples' box.
    double size = 0;

    /// Free control points or knots are stated, so that the spline's space is known beforehand.
    bool sized() const { return !axes.control_points.empty() || !options.shape.knots.empty(); }
    /// Throws Cancelled when the caller asks to stop.
    void stop_if_cancelled() const;
};

/// What the samples are, once the options have had their say. Throws InvalidInput.
SampleKind kind_of(const Samples& samples, const ShapeOptions& shape);

/// How parameters follow from points where none are given.
Parametrization rule_of(const ShapeOptions& shape, Spacing spacing);

/// Throws InvalidInput for numbers out of their range and for what is given for an option that is
/// off.
void check(const FitOptions& options);

/// Axes of the spline that the options make of the samples; throws InvalidInput where they
/// contradict each other.
Index axis_count(const Samples& samples, const ShapeOptions& shape);

/// The problem that samples and options state. What the options leave open is chosen: parameters
/// (a cloud's by projection), with no size and no tolerance stated a tolerance of a thousandth of
/// the samples' diagonal, with smoothing a size. Throws InvalidInput naming what breaks a rule.
Problem problem_of(const Samples& samples, const FitOptions& options);
/// The same where their points are scanned already.
Problem problem_of(const Samples& samples, const FitOptions& options, const PointScan& scan);

/// One tolerance per sample. Throws InvalidInput unless there is one for each, positive.
std::vector<double> sample_tolerances(const Samples& samples, const ToleranceOptions& options);

} // namespace batten
