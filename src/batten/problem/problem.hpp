#pragma once

#include <batten/problem/options.hpp>

#include <string>
#include <vector>

namespace batten {

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

/// Axes of the spline that the options make of the samples; throws InvalidInput where they
/// contradict each other.
Index axis_count(const Samples& samples, const ShapeOptions& shape);

/// The problem that samples and options state. What the options leave open is chosen: parameters
/// (a cloud's by projection), with no size and no tolerance stated a tolerance of a thousandth of
/// the samples' diagonal, with smoothing a size. Throws InvalidInput naming what breaks a rule.
Problem problem_of(const Samples& samples, const FitOptions& options);

/// Throws InvalidInput for a smoothing whose factor or order makes no sense for the axes' degrees.
void check_smoothing(const SmoothOptions& smooth, const AxisPlan& axes);

/// One tolerance per sample. Throws InvalidInput unless there is one for each, positive.
std::vector<double> sample_tolerances(const Samples& samples, const ToleranceOptions& options);

} // namespace batten
