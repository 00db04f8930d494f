#include <batten/core/stopwatch.hpp>
#include <batten/problem/held.hpp>
#include <batten/problem/subset.hpp>
#include <batten/samples/corners.hpp>
#include <batten/samples/noise.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/curve_refining.hpp>
#include <batten/search/curve_verdict.hpp>
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

/// Without the corners that have too few samples between them and the one before, or an end: a
/// piece of the curve of its own needs degree + 1.
std::vector<Index> spaced_corners(const std::vector<Index>& corners, const CurveTask& task) {
    const Index m = task.samples.size();
    const bool closed = task.closure == Closure::closed;
    const bool free_seam = closed && task.seam_continuity >= task.degree - 1;
    const auto distinct = [&](Index from, Index to) { // parameters from one sample to the other
        Index count = 1;
        for (Index i = from; i < to; ++i)
            count += task.parameters[static_cast<std::size_t>(i + 1)] >
                             task.parameters[static_cast<std::size_t>(i)]
                         ? 1
                         : 0;
        return count;
    };
    std::vector<Index> kept;
    for (Index i : corners) {
        const Index before = kept.empty() ? 0 : kept.back();
        const bool after_nothing = free_seam && kept.empty();
        if (i > 0 && !after_nothing && distinct(before, i) <= task.degree) continue;
        if (i > 0 && !free_seam && distinct(i, m - 1) <= task.degree) continue;
        kept.push_back(i);
    }
    // round the seam, from the last corner to the first
    if (closed && kept.size() > 1 &&
        distinct(kept.back(), m - 1) + distinct(0, kept.front()) <= task.degree)
        kept.pop_back();
    return kept;
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
    const std::vector<Index> spaced = spaced_corners(corners, task);
    for (Index i : corners)
        if (!std::ranges::binary_search(spaced, i))
            throw InvalidInput(
                fmt::format("corner {}: too few samples between it and the corner or "
                            "end beside it; a piece of degree {} needs {}",
                            i, task.degree, task.degree + 1));
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
        cornered.corners = spaced_corners(find_corners(task.samples.points, task.closure), task);
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
    // what is wild is searched again before anything is taken out
    if (!best.met) return best;
    const bool wild = task.roughness == 0 && between(task, best.trial) > wild_part;
    if (!wild) thin_out(task, best);
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

/// The integral of the squared second derivative that the samples show where they bend by more
/// than twice the tolerance, for parameters over [0, 1].
double shown_roughness(const CurveTask& task) {
    const Points& q = task.samples.points;
    const std::vector<double>& t = task.parameters;
    double sum = 0;
    for (Index i = 1; i + 1 < q.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double before = t[k] - t[k - 1];
        const double after = t[k + 1] - t[k];
        if (!(before > 0) || !(after > 0)) continue;
        double square = 0;
        for (Index d = 0; d < q.dim(); ++d) {
            const double chord = (after * q(i - 1, d) + before * q(i + 1, d)) / (before + after);
            square += (q(i, d) - chord) * (q(i, d) - chord);
        }
        const double bend = std::max(0.0, std::sqrt(square) - 2 * task.tolerance[k]);
        const double second = 2 * bend / (before * after);
        sum += second * second * (before + after) / 2;
    }
    return sum;
}

/// Where knots stand nearly as close as samples, a curve may be within the tolerance and wild
/// between them: the search is done again with a little roughness counted, such that what the
/// samples show of it costs a small part of the tolerance.
void calm_down(CurveTask& task, const ToleranceOptions& options, Index most, double tolerance,
               CurveWithin& found) {
    if (!found.trial.control.empty() && found.met && between(task, found.trial) <= 1) return;
    const bool unthinned = found.met && between(task, found.trial) > wild_part;
    const double shown = std::max(shown_roughness(task), 1e-300);
    const double noise_part = noise_level(task.samples.points) / tolerance;
    const bool noisy = noise_part >= 0.3 && task.samples.size() <= 5000;
    bool calmed = false;
    for (double part : {0.1, 1.0}) {
        if (!noisy || (calmed && between(task, found.trial) <= wild_part)) break;
        CurveTask calmer = task;
        calmer.roughness = part * tolerance * tolerance / shown;
        CurveWithin again = few_knots(calmer, options, most);
        const bool better =
            again.met && (!found.met || between(task, again.trial) < between(task, found.trial));
        if (!better) continue;
        found = std::move(again);
        task.roughness = calmer.roughness;
        calmed = true;
    }
    if (unthinned && !calmed) thin_out(task, found);
}

constexpr Index few_enough = 40; // control points for which a second search takes little time

/// A curve that bends more often than the samples show is searched again, without these bends.
void take_out_inflections(const CurveTask& task, const ToleranceOptions& options, Index most,
                          double tolerance, CurveWithin& found) {
    if (!found.met || task.most_inflections >= 0 || !can_show_inflections(task)) return;
    const double height = visible_height(task, tolerance);
    const Index shown = shown_inflections(task, height);
    if (curve_inflections(found.trial, height) <= shown) return;
    if (near_interpolation(task, found)) return; // it bends with the samples' noise
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

} // namespace

Fitted curve_within(const Problem& given) {
    Fitted result;
    FitReport& report = result.report;
    Stopwatch watch;
    const Subset turn = one_turn(given);
    const Problem problem = turn.of(with_seam_at_first(given, turn));
    const FitOptions& options = problem.options;
    const Samples& samples = problem.samples;
    CurveTask task = task_of(problem);
    const double smallest = *std::min_element(task.tolerance.begin(), task.tolerance.end());
    task.most_inflections = allowed_inflections(task, smallest);
    const Index limit = options.tolerance.max_control_points;
    const Index most = std::max<Index>(
        task.degree + 1,
        limit > 0 ? limit : static_cast<Index>(most_part * static_cast<double>(samples.size())));
    const double noise = noise_level(samples.points);
    // on many samples third differences are noise alone: then no search is needed to know
    const bool hopeless = samples.size() > 1000 && noise > smallest;
    CurveWithin found =
        hopeless ? smooth_fit(task, noise, most) : few_knots(task, options.tolerance, most);
    if (!hopeless) calm_down(task, options.tolerance, most, smallest, found);
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
    if (!turn.whole())
        result.parameters.axes[0].push_back(found.trial.parameters[0] + found.trial.knots.length());
    report.tolerance = smallest;
    report.termination = met ? Termination::tolerance_met : Termination::tolerance_not_met;
    judge(task, found, noise, not_met_words(task, noise, smallest, most, limit > 0), report);
    result.judged_by = DeviationKind::distance;
    return result;
}

} // namespace batten
