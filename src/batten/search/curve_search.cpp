#include <batten/core/stopwatch.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/problem/subset.hpp>
#include <batten/samples/corners.hpp>
#include <batten/samples/noise.hpp>
#include <batten/search/curve_corners.hpp>
#include <batten/search/curve_direction.hpp>
#include <batten/search/curve_exchange.hpp>
#include <batten/search/curve_fewest.hpp>
#include <batten/search/curve_missed.hpp>
#include <batten/search/curve_verdict.hpp>
#include <batten/search/residual_noise.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <optional>
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
    task.seam_stated = seam > 0;
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

NotMet why_not(const CurveTask& task, const ToleranceOptions& options, const CurveWithin& found) {
    if (options.max_control_points > 0) return NotMet::limited;
    if (found.trial.worst <= 1) return NotMet::wild;
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
    outcome.why = NotMet::noise;
    return true;
}

/// Searches for the tolerance; where it is not met and the samples' noise rules it out, for the
/// best smooth curve.
CurveOutcome searched(CurveTask& task, const ToleranceOptions& options, Index most) {
    const Points& q = task.samples.points;
    const double tolerance = tightest(task);
    const bool free = options.max_control_points == 0;
    CurveOutcome outcome;
    // of many samples the noise alone can rule a tolerance out: then no search is needed to know
    const bool many = free && q.size() > 1000 && noise_bound(q) > tolerance;
    if (many) outcome.noise = residual_noise(q);
    if (outcome.noise > tolerance && finds_smooth(task, most, outcome)) return outcome;
    if (options.corners == Corners::automatic) task.sharp = find_corners(q, task.closure);
    outcome.found = by_exchange(task, most, [&](CurveTask& some, Index fewest) {
        return fewest_knots(some, options, fewest);
    });
    const bool met = outcome.found.met;
    const bool near = near_interpolation(outcome.found.trial.knots.free_count(), q.size());
    if (!many && (near || !met)) outcome.noise = residual_noise(q);
    outcome.why = why_not(task, options, outcome.found);
    if (!met && free && outcome.noise > tolerance / 3) finds_smooth(task, most, outcome);
    return outcome;
}

/// The task with its samples turned round, which must outlive it.
CurveTask turned_task(const CurveTask& task, const Turned& turned, const Samples& samples,
                      const ShapeOptions& shape) {
    CurveTask result{.samples = samples,
                     .tolerance = turned(task.tolerance),
                     .degree = task.degree,
                     .closure = task.closure,
                     .hold = turned(task.hold),
                     .most_inflections = task.most_inflections,
                     .most_turning = task.most_turning,
                     .seam_continuity = task.seam_continuity,
                     .seam_stated = task.seam_stated,
                     .unit = task.unit,
                     .cancelled = task.cancelled};
    // not those of the task: rounding would tell the directions apart
    result.parameters =
        shape.parameters
            ? turned.parameters(task.parameters, task.parameters.front(), task.parameters.back())
            : parametrize_sequence(samples.points,
                                   shape.parametrization.value_or(Parametrization::chord),
                                   task.closure);
    for (Index corner : task.corners) result.corners.push_back(turned(corner));
    std::ranges::sort(result.corners);
    return result;
}

/// The last resort: the curve through every sample, or that it is wild.
void go_through(const CurveTask& task, CurveOutcome& outcome) {
    CurveWithin through = curve_through(task);
    if (through.trial.control.empty() || through.trial.worst > 1) return;
    if (!through.met) {
        outcome.why = NotMet::wild; // whatever must hold: it holds there
        return;
    }
    CurveWithin& found = outcome.found;
    found.trial = std::move(through.trial);
    found.met = true;
    found.stages.insert(found.stages.end(), through.stages.begin(), through.stages.end());
}

/// The search in the direction that the samples themselves determine, then in the other where that
/// does not meet the tolerance; if neither does, for the closest curve that may be handed out.
CurveOutcome searched_either_way(CurveTask& task, const FitOptions& options, Index most) {
    const Turned turned(task.samples.size(), task.closure);
    // given parameters of a closed curve need not begin at the seam, from which turned ones count
    const bool turns = task.closure == Closure::open || !options.shape.parameters;
    const bool first_backwards = turns && runs_backwards(task.samples.points, task.closure);
    const bool both = turns && task.samples.size() <= few_samples;
    Samples reverse;
    std::optional<CurveTask> backwards;
    std::vector<CurveTask*> ways;
    if (both || !first_backwards) ways.push_back(&task);
    if (both || first_backwards) {
        reverse = turned(task.samples);
        backwards.emplace(turned_task(task, turned, reverse, options.shape));
        ways.insert(first_backwards ? ways.begin() : ways.end(), &*backwards);
    }
    std::vector<CurveOutcome> outcomes;
    std::size_t best = 0;
    for (CurveTask* way : ways) {
        outcomes.push_back(searched(*way, options.tolerance, most));
        if (!outcomes.back().found.met && outcomes.back().why != NotMet::noise) continue;
        best = outcomes.size() - 1;
        ways.resize(outcomes.size());
        break;
    }
    const bool answered = outcomes[best].found.met || outcomes[best].why == NotMet::noise;
    double reached = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < ways.size() && !answered; ++k) {
        CurveWithin& found = outcomes[k].found;
        found = closest_curve(*ways[k], options.tolerance, most, found, reached);
        if (found.trial.control.empty() || !(found.trial.worst < reached)) continue;
        reached = found.trial.worst;
        best = k;
        if (found.met) break;
    }
    if (!answered && !outcomes[best].found.met && may_go_through(task, options.tolerance))
        go_through(*ways[best], outcomes[best]);
    CurveTrial& trial = outcomes[best].found.trial;
    if (ways[best] != &task && !trial.control.empty()) trial = turned(trial);
    return std::move(outcomes[best]);
}

bool within(const std::vector<double>& away, const std::vector<double>& tolerance) {
    return std::ranges::equal(away, tolerance, std::ranges::less_equal());
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
    limit_inflections(task, allowed_inflections(task, smallest));
    if (options.tolerance.corners == Corners::given)
        task.corners = checked_corners(options.tolerance.corner_samples, task);
    const Index limit = options.tolerance.max_control_points;
    const Index most = std::max<Index>(
        task.degree + 1,
        limit > 0 ? limit : static_cast<Index>(most_part * static_cast<double>(samples.size())));
    CurveOutcome outcome = searched_either_way(task, options, most);
    CurveWithin& found = outcome.found;
    if (found.trial.control.empty() && !found.trial.conflict.empty())
        throw ConstraintConflict(found.trial.conflict);
    if (found.trial.control.empty())
        throw SolverError("no number of control points gives a solvable system: the samples' "
                          "parameters coincide");
    const Spline spline = spline_of(found.trial);
    const Parameters parameters{{found.trial.parameters}, {}};
    std::vector<double> away = deviations(spline, samples, parameters, DeviationKind::distance);
    // closest points may be nearer than those that the search had
    if (!found.met && outcome.why != NotMet::noise && within(away, task.tolerance) &&
        acceptable(task, found.trial))
        found.met = true;
    Fitted result{spline, parameters, judged(task, outcome, limit, *std::ranges::max_element(away)),
                  DeviationKind::distance};
    if (!turn.whole()) {
        result.parameters.axes[0].push_back(parameters.axes[0][0] + found.trial.knots.length());
        away.push_back(away[0]);
    }
    result.deviations = std::move(away);
    result.report.seconds.emplace_back("search", watch.lap());
    return result;
}

} // namespace batten
