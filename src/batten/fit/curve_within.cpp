#include <batten/core/stopwatch.hpp>
#include <batten/fit/corners.hpp>
#include <batten/fit/curve_knots.hpp>
#include <batten/fit/curve_tolerance.hpp>
#include <batten/fit/held.hpp>
#include <batten/fit/tolerance.hpp>
#include <batten/fit/within.hpp>
#include <batten/measure/between_samples.hpp>
#include <batten/measure/inflections.hpp>
#include <batten/shape/polygon.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// A closed run without the repetition of its first sample at the end; what is said of that one
/// holds for the first.
struct OneTurn {
    Samples samples;
    HoldOptions hold;
};

OneTurn without_seam(const Samples& samples, HoldOptions hold, Closure closure) {
    OneTurn result{samples, std::move(hold)};
    const Index m = samples.size();
    if (closure == Closure::open || m <= 2 ||
        !std::ranges::equal(samples.points[0], samples.points[m - 1]))
        return result;
    result.samples.points = samples.points.slice(0, m - 1);
    if (!result.samples.weights.empty()) result.samples.weights.pop_back();
    std::vector<Index>& exact = result.hold.interpolate;
    if (std::ranges::count(exact, 0) > 0) std::erase(exact, m - 1);
    std::ranges::replace(exact, m - 1, Index{0});
    for (HeldTangent& tangent : result.hold.tangents)
        if (tangent.sample == m - 1) tangent.sample = 0;
    return result;
}

std::vector<Index> checked_corners(std::vector<Index> corners, const CurveTask& task) {
    const Index m = task.samples.size();
    const bool closed = task.closure == Closure::closed;
    std::ranges::sort(corners);
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (Index i : corners)
        if (i < 0 || i >= m)
            throw InvalidInput(fmt::format("corner {}: the samples are 0 to {}", i, m - 1));
    if (!closed) // the ends are free to have any direction already
        std::erase_if(corners, [&](Index i) { return i == 0 || i == m - 1; });
    return corners;
}

/// Corners, a seam that is held and samples with tangents: their parameters must stay.
std::vector<Index> fixed_samples(const CurveTask& task) {
    std::vector<Index> fixed = task.corners;
    if (task.closure == Closure::closed && task.seam_continuity < task.degree - 1)
        fixed.push_back(0);
    for (const HeldTangent& tangent : task.hold.tangents) fixed.push_back(tangent.sample);
    std::ranges::sort(fixed);
    fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
    return fixed;
}

/// Refines without corners and with them, and thins out what took fewer control points.
CurveWithin few_knots(CurveTask& task, const ToleranceOptions& options, Index most) {
    if (options.corners == Corners::given)
        task.corners = checked_corners(options.corner_samples, task);
    task.fixed = fixed_samples(task);
    CurveWithin best = refined(task, most);
    if (options.corners == Corners::automatic) {
        CurveTask cornered = task;
        cornered.corners = find_corners(task.samples.points, task.closure);
        if (!cornered.corners.empty()) {
            cornered.fixed = fixed_samples(cornered);
            CurveWithin other = refined(cornered, most);
            const auto count = [](const CurveWithin& fit) { return fit.trial.knots.free_count(); };
            const bool better = other.met != best.met ? other.met
                                : other.met           ? count(other) < count(best)
                                                      : other.trial.worst < best.trial.worst;
            if (better) {
                best = std::move(other);
                task.corners = std::move(cornered.corners);
                task.fixed = std::move(cornered.fixed);
            }
        }
    }
    if (best.met) thin_out(task, best);
    return best;
}

std::string not_met_words(const CurveTask& task, double noise, double tolerance, Index most,
                          bool limit_stated) {
    if (limit_stated)
        return fmt::format("not met: {} control points are allowed and do not suffice", most);
    if (noise > tolerance / 3)
        return fmt::format("not met: the samples' noise level is {:.3g}, and only a curve through "
                           "nearly every sample would follow it; "
                           "this is the best smooth fit found",
                           noise);
    if (task.most_inflections >= 0 || task.hold.equalities())
        return "not met: what must hold keeps the curve from some samples; without it they might "
               "be "
               "reached";
    return fmt::format(
        "not met: more than {:.0f} % of the samples would be needed as control points",
        100 * most_part);
}

/// The best smooth fit to samples whose noise rules the tolerance out: within what the noise's
/// extremes ask for.
CurveWithin smooth_fit(CurveTask task, double noise, Index most) {
    const double m = static_cast<double>(task.samples.size());
    task.fixed = fixed_samples(task);
    for (double& t : task.tolerance) t = std::max(t, noise * (1 + std::sqrt(2 * std::log(m))));
    CurveWithin smooth = refined(task, most);
    if (smooth.met && task.samples.size() <= 5000)
        thin_out(task, smooth); // a thousand more samples per knot: nothing to gain
    return smooth;
}

/// Inflections that the samples show, turns smaller than `height` left out.
Index shown_inflections(const CurveTask& task, double height) {
    return visible_inflections(task.samples.points, height, task.closure);
}

/// Inflections that the shape to be kept allows; -1: any number.
Index allowed_inflections(const CurveTask& task, double tolerance) {
    if (task.hold.preserve == Preserve::nothing) return -1;
    if (task.samples.dim() != 2)
        throw InvalidInput(fmt::format(
            "preserve: shape is kept for curves in the plane, not for a curve in dimension {}",
            task.samples.dim()));
    const Index shown = shown_inflections(task, tolerance);
    if (task.hold.preserve == Preserve::convexity && shown > 0)
        throw InvalidInput(fmt::format("preserve convexity: the samples have {} {} larger than the "
                                       "tolerance {}",
                                       shown, shown == 1 ? "inflection" : "inflections",
                                       tolerance));
    return shown;
}

/// What the samples and options ask for.
CurveTask task_of(const OneTurn& turn, const FitOptions& options,
                  const std::vector<double>& tolerance) {
    const ShapeOptions& shape = options.shape;
    const Samples& samples = turn.samples;
    CurveTask task{.samples = samples,
                   .tolerance = tolerance,
                   .degree = shape.degree[0],
                   .closure = shape.closures[0],
                   .hold = turn.hold};
    if (task.degree < 1 || task.degree > max_degree)
        throw InvalidInput(
            fmt::format("axis 0: degree {} is outside 1 to {}", task.degree, max_degree));
    if (samples.size() < task.degree + 1)
        throw InvalidInput(fmt::format("axis 0: degree {} needs at least {} samples, got {}",
                                       task.degree, task.degree + 1, samples.size()));
    check_held(task.hold, samples, {task.degree}, {task.closure});
    if (shape.seam_continuity > task.degree - 1)
        throw InvalidInput(fmt::format("closed: continuity C{} at the seam is more than degree {} "
                                       "has anywhere, C{}",
                                       shape.seam_continuity, task.degree, task.degree - 1));
    task.seam_continuity = shape.seam_continuity < 0 ? task.degree - 1 : shape.seam_continuity;
    if (shape.parameters) check(*shape.parameters, samples);
    task.parameters = shape.parameters ? shape.parameters->axes[0]
                                       : parametrize_sequence(samples.points, shape.parametrization,
                                                              task.closure);
    task.cancelled = options.cancelled;
    return task;
}

constexpr Index most_for_inflections = 20000; // samples: beyond it they show noise

/// Inflections of a planar curve, turns smaller than `height` left out.
Index curve_inflections(const CurveTrial& trial, double height) {
    const std::vector<double> breaks = trial.knots.breakpoints();
    constexpr Index steps = 32; // per piece
    PointSet t(static_cast<Index>(breaks.size() - 1) * steps + 1, 1);
    for (Index i = 0; i < t.size(); ++i) {
        const Index piece = std::min(i / steps, static_cast<Index>(breaks.size()) - 2);
        const auto b = static_cast<std::size_t>(piece);
        t(i, 0) = breaks[b] +
                  (breaks[b + 1] - breaks[b]) * static_cast<double>(i - piece * steps) / steps;
    }
    return visible_inflections(evaluate(spline_of(trial), t), height, trial.knots.closure());
}

bool can_show_inflections(const CurveTask& task) {
    return task.samples.dim() == 2 && task.samples.size() <= most_for_inflections;
}

/// Height of the turns that count as inflections: those that a kept shape may not have, or smaller
/// ones that would still be seen.
double visible_height(const CurveTask& task, double tolerance) {
    return task.most_inflections >= 0 ? tolerance : tolerance / 4;
}

constexpr Index few_enough = 40; // control points for which a second search takes little time

/// A curve that bends more often than the samples show is searched again, without these bends.
void take_out_inflections(const CurveTask& task, const ToleranceOptions& options, Index most,
                          double tolerance, CurveWithin& found) {
    if (!found.met || task.most_inflections >= 0 || !can_show_inflections(task)) return;
    const double height = visible_height(task, tolerance);
    const Index shown = shown_inflections(task, height);
    if (curve_inflections(found.trial, height) <= shown) return;
    CurveTask shaped = task;
    shaped.most_inflections = shown;
    const auto accepted = [&](CurveWithin again) {
        const double strays = std::max(1.0, between(task, found.trial));
        if (!again.met || between(task, again.trial) > strays) return false;
        found = std::move(again);
        return true;
    };
    CurveWithin again = refined_further(shaped, found, most);
    if (again.met) thin_out(shaped, again);
    if (accepted(std::move(again)) || found.trial.knots.free_count() > few_enough) return;
    accepted(few_knots(shaped, options, most)); // from nothing: other knots may do
}

/// Counts the inflections of curve and samples where they can be told.
void count_inflections(const CurveTask& task, const CurveWithin& found, FitReport& report) {
    if (!can_show_inflections(task)) return;
    const double height = visible_height(task, report.tolerance);
    report.curve_inflections = curve_inflections(found.trial, height);
    report.data_inflections = shown_inflections(task, height);
    if (task.most_inflections >= 0)
        report.inflections = inflection_count(found.trial.control, task.closure);
}

/// The verdict in words and what it rests on.
void judge(const CurveTask& task, const CurveWithin& found, double noise,
           const std::string& why_not, FitReport& report) {
    bool met = report.termination == Termination::tolerance_met;
    const BetweenSamples between = check_between(spline_of(found.trial), task.samples.points,
                                                 found.trial.parameters, task.tolerance);
    report.between_samples = between.excess;
    count_inflections(task, found, report);
    const bool wild = met && between.excess > wild_part;
    if (wild) {
        met = false;
        report.termination = Termination::tolerance_not_met;
    }
    const Index n = found.trial.knots.free_count();
    const Index m = task.samples.size();
    const bool near = static_cast<double>(n) > smooth_part * static_cast<double>(m);
    report.noise_level = near || !met ? noise : 0;
    report.verdict = met    ? "met"
                     : wild ? "not met: every sample is within, but the curve is wild between some"
                            : why_not;
    if (met && near)
        report.verdict += fmt::format(", but it nearly interpolates: {} control points for {} "
                                      "samples; noise level seen in them {:.3g}",
                                      n, m, noise);
    if (!between.good && (met || wild))
        report.verdict +=
            between.loops > 0
                ? fmt::format("; between samples {} and the next the curve has a loop",
                              between.worst_sample)
                : fmt::format(
                      "; between samples {} and the next the curve strays {:.2g} times as far as "
                      "allowed",
                      between.worst_sample, between.excess);
    if (met && report.curve_inflections > report.data_inflections)
        report.verdict += fmt::format("; the curve has {} inflections, the samples show {}",
                                      report.curve_inflections, report.data_inflections);
}

} // namespace

FitResult curve_within(const Samples& given, const FitOptions& options,
                       std::vector<double> tolerance) {
    FitResult result;
    FitReport& report = result.report;
    Stopwatch watch;
    const ShapeOptions& shape = options.shape;
    if (shape.degree.size() != 1 || shape.closures.size() != 1)
        throw InvalidInput("degree, closed: one value is needed for a curve");
    const OneTurn turn = without_seam(given, options.hold, shape.closures[0]);
    const Samples& samples = turn.samples;
    tolerance.resize(static_cast<std::size_t>(samples.size()));
    CurveTask task = task_of(turn, options, tolerance);
    const double smallest = *std::min_element(tolerance.begin(), tolerance.end());
    task.most_inflections = allowed_inflections(task, smallest);
    report.seconds.emplace_back("parametrize", watch.lap());
    const Index limit = options.tolerance.max_control_points;
    const Index most = std::max<Index>(
        task.degree + 1,
        limit > 0 ? limit : static_cast<Index>(most_part * static_cast<double>(samples.size())));
    const double noise = noise_level(samples.points);
    // on many samples third differences are noise alone: then no search is needed to know
    const bool hopeless = samples.size() > 5000 && noise > smallest;
    CurveWithin found =
        hopeless ? smooth_fit(task, noise, most) : few_knots(task, options.tolerance, most);
    if (!hopeless) take_out_inflections(task, options.tolerance, most, smallest, found);
    const bool met = found.met && !hopeless;
    if (!met && !hopeless && noise > smallest / 3 &&
        limit == 0) { // the last refinement is a near-interpolation in disguise
        CurveWithin smooth = smooth_fit(
            task, noise, static_cast<Index>(smooth_part * static_cast<double>(samples.size())));
        if (smooth.met) found = std::move(smooth);
    }
    if (found.trial.control.empty() && !found.trial.conflict.empty())
        throw ConstraintConflict(found.trial.conflict);
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
    judge(task, found, noise, not_met_words(task, noise, smallest, most, limit > 0), report);
    report.deviation.kind = DeviationKind::distance;
    return result;
}

} // namespace batten
