#include <batten/core/stopwatch.hpp>
#include <batten/problem/held.hpp>
#include <batten/problem/subset.hpp>
#include <batten/samples/noise.hpp>
#include <batten/search/curve_fewest.hpp>
#include <batten/search/curve_verdict.hpp>
#include <batten/search/residual_noise.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

/// A closed run without the repetition of its first sample at the end; what is said of that one
/// holds for the first.
Subset one_turn(const Problem& problem) {
    const Points& points = problem.samples.points;
    const Index m = points.size();
    const bool repeated = problem.axes.closures[0] == Closure::closed && m > 2 &&
                          std::ranges::equal(points[0], points[m - 1]);
    return Subset::without(repeated ? std::vector<Index>{m - 1} : std::vector<Index>{}, m);
}

Problem with_seam_at_first(Problem problem, const Subset& turn) {
    if (turn.whole()) return problem;
    const Index last = problem.samples.size() - 1;
    std::vector<Index>& exact = problem.options.hold.interpolate;
    if (std::ranges::count(exact, 0) > 0) std::erase(exact, last);
    std::ranges::replace(exact, last, Index{0});
    for (HeldTangent& tangent : problem.options.hold.tangents)
        if (tangent.sample == last) tangent.sample = 0;
    std::ranges::replace(problem.options.tolerance.corner_samples, last, Index{0});
    return problem;
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

/// What the problem asks for.
CurveTask task_of(const Problem& problem) {
    const Samples& samples = problem.samples;
    const int seam = problem.options.shape.seam_continuity;
    CurveTask task{.samples = samples,
                   .tolerance = problem.tolerance,
                   .degree = problem.axes.degree[0],
                   .closure = problem.axes.closures[0],
                   .hold = problem.options.hold,
                   .parameters = problem.parameters.axes[0],
                   .unit = problem.options.unit,
                   .cancelled = problem.options.cancelled};
    task.seam_continuity = seam < 0 ? task.degree - 1 : seam;
    const bool closed = task.closure == Closure::closed;
    const int least = closed ? 2 * task.degree + 2 : task.degree + 1;
    if (samples.size() < least)
        throw InvalidInput(fmt::format("axis 0: {}degree {} needs at least {} samples, got {}",
                                       closed ? "closed, " : "", task.degree, least,
                                       samples.size()));
    const auto distinct =
        1 +
        std::ranges::count_if(task.parameters, [last = task.parameters.front()](double t) mutable {
            return std::exchange(last, t) < t;
        });
    if (distinct < least)
        throw InvalidInput(fmt::format("axis 0: {}degree {} needs at least {} samples at different "
                                       "places, got {}",
                                       closed ? "closed, " : "", task.degree, least, distinct));
    return task;
}

NotMet why_not(const CurveTask& task, const ToleranceOptions& options,
               const CurveOutcome& outcome) {
    if (options.max_control_points > 0) return NotMet::limited;
    if (outcome.noise > tightest(task) / 3) return NotMet::noise;
    if (outcome.found.trial.worst <= 1) return NotMet::wild;
    if (task.most_inflections >= 0 || task.hold.equalities()) return NotMet::held;
    return NotMet::crowded;
}

/// Whether there is a smooth curve for the samples' noise that may be handed out; then it is found.
bool finds_smooth(const CurveTask& task, Index most, CurveOutcome& outcome) {
    const auto smooth_most =
        static_cast<Index>(smooth_part * static_cast<double>(task.samples.size()));
    CurveWithin smooth = smooth_curve(task, outcome.noise, std::min(most, smooth_most));
    if (!smooth.met || !acceptable(task, smooth.trial)) return false;
    smooth.met = false;
    outcome.found = std::move(smooth);
    return true;
}

/// Searches for the tolerance; where it is not met, for the best smooth curve if the samples' noise
/// rules the tolerance out, else for the closest that may be handed out.
CurveOutcome searched(CurveTask& task, const ToleranceOptions& options, Index most) {
    const Points& q = task.samples.points;
    CurveOutcome outcome;
    // of many samples the noise alone can rule a tolerance out: then no search is needed to know
    const bool many = q.size() > 1000 && noise_bound(q) > tightest(task);
    if (many) outcome.noise = residual_noise(q);
    outcome.why = why_not(task, options, outcome);
    if (outcome.noise > tightest(task) && finds_smooth(task, most, outcome)) return outcome;
    CurveWithin& found = outcome.found;
    found = fewest_knots(task, options, most);
    const bool near = near_interpolation(found.trial.knots.free_count(), q.size());
    if (!many && (near || !found.met)) outcome.noise = residual_noise(q);
    if (found.met) return outcome;
    outcome.why = why_not(task, options, outcome);
    if (outcome.why == NotMet::noise && finds_smooth(task, most, outcome)) return outcome;
    CurveWithin closest = closest_curve(task, options, most, found);
    closest.trial.conflict = found.trial.conflict;
    found = std::move(closest);
    return outcome;
}

} // namespace

Fitted curve_within(const Problem& given) {
    Stopwatch watch;
    const Subset turn = one_turn(given);
    const Problem problem = turn.of(with_seam_at_first(given, turn));
    const FitOptions& options = problem.options;
    const Samples& samples = problem.samples;
    CurveTask task = task_of(problem);
    const double smallest = tightest(task);
    task.most_inflections = allowed_inflections(task, smallest);
    const Index limit = options.tolerance.max_control_points;
    const Index most = std::max<Index>(
        task.degree + 1,
        limit > 0 ? limit : static_cast<Index>(most_part * static_cast<double>(samples.size())));
    const CurveOutcome outcome = searched(task, options.tolerance, most);
    const CurveWithin& found = outcome.found;
    if (found.trial.control.empty() && !found.trial.conflict.empty())
        throw ConstraintConflict(found.trial.conflict);
    if (found.trial.control.empty())
        throw SolverError("no number of control points gives a solvable system: the samples' "
                          "parameters coincide");
    Fitted result{spline_of(found.trial),
                  {{found.trial.parameters}, {}},
                  judged(task, outcome, limit),
                  DeviationKind::distance};
    if (!turn.whole())
        result.parameters.axes[0].push_back(found.trial.parameters[0] + found.trial.knots.length());
    result.report.seconds.emplace_back("search", watch.lap());
    return result;
}

} // namespace batten
