#include <batten/problem/problem.hpp>

#include <batten/parametrize/noise_aware.hpp>
#include <batten/problem/held.hpp>
#include <batten/problem/plan.hpp>
#include <batten/samples/scan.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

void check_numbers(const FitOptions& options) {
    if (options.threads < 0)
        throw InvalidInput(fmt::format("threads: {} is negative", options.threads));
    const double tolerance = options.tolerance.value;
    if (tolerance != 0 && (!(tolerance > 0) || !std::isfinite(tolerance)))
        throw InvalidInput(fmt::format("tolerance {} must be positive and finite", tolerance));
    if (options.tolerance.max_control_points < 0)
        throw InvalidInput(fmt::format("at most {} control points: a positive number is needed",
                                       options.tolerance.max_control_points));
    check(options.stop);
    if (options.most_frames < 0)
        throw InvalidInput(fmt::format("frames: {} is negative", options.most_frames));
}

/// What is given for an option that is off would be ignored.
void check_asked_for(const FitOptions& options) {
    const int seam = options.shape.seam_continuity;
    if (seam < -1)
        throw InvalidInput(fmt::format("closed: continuity C{} at the seam: C0, C1, ... or -1 for "
                                       "as smooth as elsewhere",
                                       seam));
    if (options.smooth.lambda != 0 && !options.smooth.wanted)
        throw InvalidInput("smoothing: a factor is given, but smoothing is not wanted");
    if (options.method.control.size() > 0 && options.method.initial != Initial::given)
        throw InvalidInput("initial: control points are given, but the start is another");
    const PointSet& before = options.method.before;
    if (before.size() > 0 && (before.size() != options.method.control.size() ||
                              before.dim() != options.method.control.dim()))
        throw InvalidInput(fmt::format("before: {} control points of dimension {}, but {} of {} "
                                       "to start from",
                                       before.size(), before.dim(), options.method.control.size(),
                                       options.method.control.dim()));
    if (!options.tolerance.corner_samples.empty() && options.tolerance.corners != Corners::given)
        throw InvalidInput("corners: samples are given, but the corners are not the given ones");
}

/// A cloud's parameters that nobody gave: its points seen in a plane.
Parameters seen(const Samples& samples, const ShapeOptions& shape) {
    if (shape.parametrization)
        throw InvalidInput("parametrize: a cloud's parameters are its points' coordinates in a "
                           "plane, not lengths along it");
    if (std::ranges::count(shape.closures, Closure::closed) > 0)
        throw InvalidInput("closed: a cloud's parameters are its points' coordinates in a plane, "
                           "where no axis closes; give it parameters that go round");
    return projected(samples, shape.projection                 ? *shape.projection
                              : samples.order == Order::ground ? Projection::xy
                                                               : Projection::plane);
}

} // namespace

SampleKind kind_of(const Samples& samples, const ShapeOptions& shape) {
    if (shape.projection && (shape.parameters || !samples.grid.empty()))
        throw InvalidInput("project: the parameters are given already, by a file or the grid");
    if (shape.parameters && shape.parametrization)
        throw InvalidInput("parametrize: the parameters are given already");
    const bool scattered = shape.parameters && shape.parameters->is_scattered();
    if (scattered || shape.projection) return SampleKind::cloud;
    if (samples.kind() == SampleKind::cloud && shape.parameters) return SampleKind::sequence;
    return samples.kind();
}

Parametrization rule_of(const ShapeOptions& shape, Spacing spacing) {
    return shape.parametrization      ? *shape.parametrization
           : spacing == Spacing::even ? Parametrization::uniform
                                      : Parametrization::chord;
}

namespace {

Parameters chosen_parameters(const Problem& problem) {
    const Samples& samples = problem.samples;
    const ShapeOptions& shape = problem.options.shape;
    if (shape.parameters) {
        check(*shape.parameters, samples);
        return *shape.parameters;
    }
    const bool noisy = problem.options.smooth.wanted && !shape.parametrization &&
                       problem.kind == SampleKind::sequence && samples.size() > 20;
    if (noisy) return {{noise_aware_parameters(samples.points, problem.axes.closures[0])}, {}};
    const Parametrization rule = rule_of(shape, samples.spacing);
    return parameters_for_boundaries(samples, parametrize(samples, rule, problem.axes.closures),
                                     problem.options.hold.boundaries);
}

/// Says where a smooth spline may lack control points that the samples would bear.
void note_limit(Problem& problem) {
    const Index most = most_smoothing_size(problem);
    for (std::size_t k = 0; k < problem.axes.count(); ++k)
        if (problem.axes.control_points[k] == most && samples_along(problem, k) > 2 * (most + 1))
            problem.samples.notes.push_back(fmt::format(
                "axis {}: the smooth spline was sought with {} control points, fewer than half of "
                "the samples; state more where its detail is finer",
                k, most));
}

/// Without a size and a tolerance: with smoothing enough control points, else within a thousandth
/// of the data's size, where the method is left open.
void complete_size(Problem& problem) {
    FitOptions& options = problem.options;
    const std::string& method = options.method.name;
    const bool open = (method == "auto" || method == "search") && options.method.moving.empty();
    if (problem.sized() || options.tolerance.stated()) return;
    if (options.smooth.wanted) {
        problem.axes.control_points = smoothing_size(problem);
        note_limit(problem);
    } else if (open && options.stop.deviation > 0) {
        options.tolerance.value = std::exchange(options.stop.deviation, 0);
        if (options.stop.relative_gradient == 0)
            options.stop.relative_gradient = StopRule{}.relative_gradient;
    } else if (open) {
        options.tolerance.value = problem.size > 0 ? problem.size / 1000 : 1e-3;
        problem.samples.notes.emplace_back(
            "no size and no tolerance were stated: a thousandth of the data's diagonal was taken");
    }
}

} // namespace

void Problem::stop_if_cancelled() const {
    if (options.cancelled && options.cancelled()) throw Cancelled("the fit was cancelled");
}

Index axis_count(const Samples& samples, const ShapeOptions& shape) {
    if (kind_of(samples, shape) != SampleKind::cloud) return samples.axis_count();
    return shape.parameters ? shape.parameters->axis_count() : 2;
}

void check(const FitOptions& options) {
    check_numbers(options);
    check_asked_for(options);
}

Problem problem_of(const Samples& samples, const FitOptions& options) {
    const PointScan scan = scanned(samples.points);
    return problem_of(samples, options, scan);
}

Problem problem_of(const Samples& samples, const FitOptions& options, const PointScan& scan) {
    check(samples, scan);
    check(options);
    Problem problem{.samples = samples,
                    .kind = kind_of(samples, options.shape),
                    .options = options,
                    .size = diagonal_of(scan.box())};
    problem.stop_if_cancelled();
    ShapeOptions& shape = problem.options.shape;
    if (problem.kind == SampleKind::cloud && !shape.parameters) {
        shape.parameters = seen(samples, shape);
        shape.projection.reset();
    }
    problem.axes = planned(problem.options, problem.kind, samples.shape(), samples.dim(),
                           axis_count(samples, shape));
    for (Index i : options.tolerance.corner_samples) check_sample("corner", i, samples.size());
    check_held(options.hold, problem.samples, problem.kind, problem.axes);
    problem.parameters = chosen_parameters(problem);
    complete_size(problem);
    if (problem.options.tolerance.stated())
        problem.tolerance = sample_tolerances(samples, problem.options.tolerance);
    return problem;
}

std::vector<double> sample_tolerances(const Samples& samples, const ToleranceOptions& options) {
    std::vector<double> t = options.per_sample;
    if (t.empty()) t.assign(static_cast<std::size_t>(samples.size()), options.value);
    if (static_cast<Index>(t.size()) != samples.size())
        throw InvalidInput(
            fmt::format("tolerances: {} given for {} samples; one per sample is needed", t.size(),
                        samples.size()));
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(t[i] > 0) || !std::isfinite(t[i]))
            throw InvalidInput(
                fmt::format("tolerance {}: {} must be positive and finite", i, t[i]));
    if (options.value > 0)
        for (double& own : t) own = std::min(own, options.value);
    return t;
}

} // namespace batten
