#include <batten/fit/tolerance.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/fit/corners.hpp>
#include <batten/fit/curve_tolerance.hpp>
#include <batten/fit/grid_tolerance.hpp>
#include <batten/fit/plan.hpp>
#include <batten/measure/between_samples.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

double noise_level(const Points& q) {
    if (q.size() < 5) return 0;
    double sum = 0;
    for (Index i = 0; i + 3 < q.size(); ++i)
        for (Index d = 0; d < q.dim(); ++d) {
            const double third = q(i + 3, d) - 3 * q(i + 2, d) + 3 * q(i + 1, d) - q(i, d);
            sum += third * third;
        }
    return std::sqrt(
        sum /
        (20 * static_cast<double>(
                  q.size() - 3))); // a third difference of white noise has 20 times its variance
}

namespace {

constexpr double most_part = 0.9;   // of the samples may become control points
constexpr double smooth_part = 0.5; // beyond it a fit is near-interpolation

std::vector<double> tolerances(const Samples& samples, const ToleranceOptions& options) {
    std::vector<double> t = options.per_sample;
    if (t.empty()) t.assign(static_cast<std::size_t>(samples.size()), options.value);
    if (static_cast<Index>(t.size()) != samples.size())
        throw InvalidInput(
            fmt::format("tolerances: {} given for {} samples; one per sample is needed", t.size(),
                        samples.size()));
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(t[i] > 0) || !std::isfinite(t[i]))
            throw InvalidInput(
                options.per_sample.empty()
                    ? fmt::format("tolerance {} must be positive and finite", t[i])
                    : fmt::format("tolerance {}: {} must be positive and finite", i, t[i]));
    return t;
}

/// A closed run without the repetition of its first sample at the end.
Samples without_seam(const Samples& samples, Closure closure) {
    Samples result = samples;
    const Index m = samples.size();
    if (closure == Closure::closed && m > 2 &&
        std::ranges::equal(samples.points[0], samples.points[m - 1])) {
        result.points = samples.points.slice(0, m - 1);
        if (!result.weights.empty()) result.weights.pop_back();
    }
    return result;
}

/// Refines without corners and with them, and thins out what took fewer control points.
CurveWithin few_knots(CurveTask task, const ToleranceOptions& options, Index most) {
    if (options.corners == Corners::given) task.corners = options.corner_samples;
    CurveWithin best = refined(task, most);
    if (options.corners == Corners::automatic && task.closure == Closure::open) {
        CurveTask cornered = task;
        cornered.corners = find_corners(task.samples.points);
        if (!cornered.corners.empty()) {
            CurveWithin other = refined(cornered, most);
            const auto count = [](const CurveWithin& fit) { return fit.trial.knots.free_count(); };
            const bool better = other.met != best.met ? other.met
                                : other.met           ? count(other) < count(best)
                                                      : other.trial.worst < best.trial.worst;
            if (better) {
                best = std::move(other);
                task.corners = std::move(cornered.corners);
            }
        }
    }
    if (best.met) thin_out(task, best);
    return best;
}

std::string not_met_words(double noise, double tolerance, Index most, bool limit_stated) {
    if (limit_stated)
        return fmt::format("not met: {} control points are allowed and do not suffice", most);
    if (noise > tolerance / 3)
        return fmt::format("not met: the samples' noise level is {:.3g}, and only a curve through "
                           "nearly every sample would follow it; "
                           "this is the best smooth fit found",
                           noise);
    return fmt::format(
        "not met: more than {:.0f} % of the samples would be needed as control points",
        100 * most_part);
}

/// The best smooth fit to samples whose noise rules the tolerance out: within what the noise's
/// extremes ask for.
CurveWithin smooth_fit(CurveTask task, double noise, Index most) {
    const double m = static_cast<double>(task.samples.size());
    for (double& t : task.tolerance) t = std::max(t, noise * (1 + std::sqrt(2 * std::log(m))));
    CurveWithin smooth = refined(task, most);
    if (smooth.met && task.samples.size() <= 5000)
        thin_out(task, smooth); // a thousand more samples per knot: nothing to gain
    return smooth;
}

FitResult curve_within(const Samples& given, const FitOptions& options,
                       std::vector<double> tolerance) {
    FitResult result;
    FitReport& report = result.report;
    Stopwatch watch;
    const ShapeOptions& shape = options.shape;
    if (shape.degree.size() != 1 || shape.closures.size() != 1)
        throw InvalidInput("degree, closed: one value is needed for a curve");
    const Closure closure = shape.closures[0];
    const Samples samples = without_seam(given, closure);
    tolerance.resize(static_cast<std::size_t>(samples.size()));
    CurveTask task{.samples = samples,
                   .tolerance = tolerance,
                   .degree = shape.degree[0],
                   .closure = closure,
                   .hold = options.hold};
    if (task.degree < 1 || task.degree > max_degree)
        throw InvalidInput(
            fmt::format("axis 0: degree {} is outside 1 to {}", task.degree, max_degree));
    if (samples.size() < task.degree + 1)
        throw InvalidInput(fmt::format("axis 0: degree {} needs at least {} samples, got {}",
                                       task.degree, task.degree + 1, samples.size()));
    if (shape.parameters) check(*shape.parameters, samples);
    task.parameters = shape.parameters
                          ? shape.parameters->axes[0]
                          : parametrize_sequence(samples.points, shape.parametrization, closure);
    report.seconds.emplace_back("parametrize", watch.lap());
    task.cancelled = options.cancelled;
    const Index limit = options.tolerance.max_control_points;
    const Index most = std::max<Index>(
        task.degree + 1,
        limit > 0 ? limit : static_cast<Index>(most_part * static_cast<double>(samples.size())));
    const double smallest = *std::min_element(tolerance.begin(), tolerance.end());
    const double noise = noise_level(samples.points);
    // on many samples third differences are noise alone: then no search is needed to know
    const bool hopeless = samples.size() > 5000 && noise > smallest;
    CurveWithin found =
        hopeless ? smooth_fit(task, noise, most) : few_knots(task, options.tolerance, most);
    bool met = found.met && !hopeless;
    if (!met && !hopeless && noise > smallest / 3 &&
        limit == 0) { // the last refinement is a near-interpolation in disguise
        CurveWithin smooth = smooth_fit(
            task, noise, static_cast<Index>(smooth_part * static_cast<double>(samples.size())));
        if (smooth.met) found = std::move(smooth);
    }
    if (found.trial.control.empty())
        throw SolverError("no number of control points gives a solvable system: the samples' "
                          "parameters coincide");
    report.stages = found.stages;
    report.seconds.emplace_back("search", watch.lap());
    result.spline = spline_of(found.trial);
    result.parameters.axes = {found.trial.parameters};
    if (samples.size() < given.size())
        result.parameters.axes[0].push_back(found.trial.parameters[0] + found.trial.knots.length());
    report.method = "tolerance";
    report.method_reason = "knots where the error is, then as few as hold it";
    report.tolerance = smallest;
    report.termination = met ? Termination::tolerance_met : Termination::tolerance_not_met;
    const BetweenSamples between =
        check_between(result.spline, samples.points, found.trial.parameters, tolerance);
    report.between_samples = between.excess;
    constexpr double wild = 3; // beyond it what happens between the samples is no reading of them
    const bool is_wild = met && between.excess > wild;
    if (is_wild) {
        met = false;
        report.termination = Termination::tolerance_not_met;
    }
    const Index n = found.trial.knots.free_count();
    const bool near = static_cast<double>(n) > smooth_part * static_cast<double>(samples.size());
    report.noise_level = near || !met ? noise : 0;
    report.verdict = met ? "met"
                     : is_wild
                         ? "not met: every sample is within, but the curve is wild between some"
                         : not_met_words(noise, smallest, most, limit > 0);
    if (met && near)
        report.verdict += fmt::format(", but it nearly interpolates: {} control points for {} "
                                      "samples; noise level seen in them {:.3g}",
                                      n, samples.size(), noise);
    if (!between.good && (met || is_wild))
        report.verdict += fmt::format(
            "; between samples {} and the next the curve strays {:.2g} times as far as allowed",
            between.worst_sample, between.excess);
    report.deviation.kind = DeviationKind::distance;
    return result;
}

/// Greatest number of control points along each axis, so that together they are at most `part` of
/// the samples.
std::vector<Index> most_per_axis(const Samples& samples, const Parameters& parameters,
                                 const AxisPlan& plan, double part) {
    const auto axes = static_cast<double>(plan.degree.size());
    std::vector<Index> most;
    for (std::size_t k = 0; k < plan.degree.size(); ++k) {
        const double along = parameters.is_scattered()
                                 ? std::pow(static_cast<double>(samples.size()), 1 / axes)
                                 : static_cast<double>(samples.grid[k]);
        most.push_back(std::max<Index>(plan.degree[k] + 1,
                                       static_cast<Index>(std::pow(part, 1 / axes) * along)));
    }
    return most;
}

/// A grid, or a cloud with given parameters.
FitResult surface_within(const Samples& samples, const FitOptions& options,
                         const std::vector<double>& tolerance) {
    if (!options.hold.interpolate.empty())
        throw InvalidInput("tolerance: samples of a grid or cloud cannot be interpolated exactly "
                           "in a fit to a tolerance yet; state --control-points");
    FitResult result;
    FitReport& report = result.report;
    Stopwatch watch;
    ShapeOptions shape = options.shape;
    shape.control_points.clear();
    const bool cloud = shape.parameters && shape.parameters->is_scattered();
    if (cloud)
        shape.control_points.assign(1, samples.size());
    else
        for (Index m : samples.grid) shape.control_points.push_back(m);
    const AxisPlan plan = plan_axes(samples, shape);
    result.parameters = choose_parameters(samples, options.shape, plan);
    report.seconds.emplace_back("parametrize", watch.lap());
    const Index limit = options.tolerance.max_control_points;
    const double part =
        limit > 0 ? std::min(1.0, static_cast<double>(limit) / static_cast<double>(samples.size()))
                  : most_part;
    const std::vector<Index> most = most_per_axis(samples, result.parameters, plan, part);
    GridWithin found = few_knots(samples, result.parameters, tolerance, plan.degree, plan.closures,
                                 most, options.cancelled);
    if (found.spline.axis_count() == 0)
        throw SolverError(
            "no number of control points gives a solvable system: the grid's parameters coincide");
    report.stages = found.stages;
    report.seconds.emplace_back("search", watch.lap());
    const double share =
        static_cast<double>(found.stages.back().second) / static_cast<double>(samples.size());
    report.method = "tolerance";
    report.method_reason = "the fewest control points per axis that hold it";
    report.tolerance = *std::min_element(tolerance.begin(), tolerance.end());
    report.termination = found.met ? Termination::tolerance_met : Termination::tolerance_not_met;
    report.verdict =
        found.met ? "met"
        : limit > 0
            ? fmt::format("not met: {} control points are allowed and do not suffice", limit)
            : fmt::format(
                  "not met: more than {:.0f} % of the samples would be needed as control points",
                  100 * most_part);
    if (share > smooth_part)
        report.verdict +=
            fmt::format("{} it nearly interpolates: {:.0f} control points per 100 samples",
                        found.met ? ", but" : ";", 100 * share);
    result.spline = std::move(found.spline);
    return result;
}

} // namespace

FitResult fit_to_tolerance(const Samples& samples, const FitOptions& options) {
    const std::vector<double> tolerance = tolerances(samples, options.tolerance);
    if (options.hold.preserve != Preserve::nothing)
        throw InvalidInput("tolerance: a shape cannot be preserved in a fit to a tolerance yet; "
                           "state --control-points");
    if (!options.shape.knots.empty())
        throw InvalidInput("tolerance: knots are found by the fit and cannot be given, too");
    if (options.method.name != "auto")
        throw InvalidInput(fmt::format("tolerance: the method is the search's own, got {}; epia "
                                       "has its own (--stop-deviation)",
                                       options.method.name));
    const bool cloud = options.shape.parameters && options.shape.parameters->is_scattered();
    return samples.grid.empty() && !cloud ? curve_within(samples, options, tolerance)
                                          : surface_within(samples, options, tolerance);
}

} // namespace batten
