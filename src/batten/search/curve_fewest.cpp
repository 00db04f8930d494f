#include <batten/search/curve_fewest.hpp>

#include <batten/samples/corners.hpp>
#include <batten/samples/noise.hpp>
#include <batten/samples/samples.hpp>
#include <batten/search/curve_corners.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/curve_rising.hpp>
#include <batten/search/curve_spread.hpp>
#include <batten/search/curve_verdict.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace batten {

namespace {

Index controls(const CurveWithin& fit) {
    return fit.trial.knots.free_count();
}

constexpr Index few_enough = 40; // control points for which a second search takes little time

/// A met fit's rivals that rise from the fewest knots, and what can be squeezed out of the best.
void rise_and_squeeze(const CurveTask& task, CurveWithin& best) {
    for (int smoothing : {evenly, 12}) {
        CurveWithin again = risen(task, controls(best) - 1, smoothing);
        if (!again.met) continue;
        again.closest = best.closest;
        best = std::move(again);
    }
    if (controls(best) <= few_enough) squeeze(task, best);
}

/// Whether a met fit is too wild between the samples to be handed out.
bool is_wild(const CurveTask& task, const CurveWithin& fit) {
    return between(task, fit.trial) > wild_part;
}

/// What rises from the fewest knots, where refining missed the tolerance or is wild.
void rise_instead(const CurveTask& task, Index most, CurveWithin& best) {
    if (best.met && !is_wild(task, best)) return;
    CurveTask rising = task;
    for (double strays : {1.0, wild_part}) {
        rising.between = strays;
        for (int smoothing : {evenly, 12}) {
            CurveWithin again = risen(rising, most, smoothing);
            best.closest.see(task, again.closest);
            if (!again.met) continue;
            again.closest = best.closest;
            best = std::move(again);
            return;
        }
    }
}

/// Refines without corners and with them: what took fewer control points, or came nearer.
CurveWithin refined_with_corners(CurveTask& task, const ToleranceOptions& options, Index most) {
    task.fixed = fixed_samples(task);
    CurveWithin best = refined(task, most);
    if (options.corners == Corners::automatic) {
        CurveTask cornered = task;
        cornered.corners = spaced_corners(find_corners(task.samples.points, task.closure), task);
        if (!cornered.corners.empty()) {
            cornered.fixed = fixed_samples(cornered);
            CurveWithin other = refined(cornered, most);
            ClosestSeen closest = best.closest;
            closest.see(cornered, other.closest);
            const bool better = other.met != best.met ? other.met
                                : other.met           ? controls(other) < controls(best)
                                                      : other.trial.worst < best.trial.worst;
            if (better) {
                best = std::move(other);
                task.corners = std::move(cornered.corners);
                task.fixed = std::move(cornered.fixed);
            }
            best.closest = std::move(closest);
        }
    }
    return best;
}

/// The fewest control points from one search: refined or risen, thinned out, squeezed.
CurveWithin refined_and_thinned(CurveTask& task, const ToleranceOptions& options, Index most) {
    const bool few = task.samples.size() <= few_samples;
    CurveWithin best = refined_with_corners(task, options, most);
    if (few) rise_instead(task, most, best);
    // what is wild is searched again before anything is taken out
    if (!best.met || (task.roughness == 0 && is_wild(task, best))) return best;
    thin_out(task, best);
    if (few) rise_and_squeeze(task, best);
    return best;
}

/// Searches for tighter tolerances, too: a curve found there may lead to fewer control points.
void look_beyond(CurveTask& task, const ToleranceOptions& options, Index most, CurveWithin& best) {
    for (double part : {0.3, 0.1}) {
        if (!best.met || controls(best) > few_enough || task.samples.size() > few_samples) return;
        CurveTask tighter = task;
        for (double& t : tighter.tolerance) t *= part;
        CurveWithin again =
            refined_and_thinned(tighter, options, std::min(most, controls(best) * 3 / 2 + 10));
        if (!again.met) return;
        again.trial = rescaled(again.trial, part);
        if (between(task, again.trial) > std::max(1.0, between(task, best.trial))) continue;
        squeeze(task, again);
        if (controls(again) >= controls(best)) continue;
        again.closest = best.closest;
        best = std::move(again);
        task.corners = std::move(tighter.corners);
        task.fixed = std::move(tighter.fixed);
    }
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
void calm_down(CurveTask& task, const ToleranceOptions& options, Index most, CurveWithin& found) {
    if (!found.trial.control.empty() && found.met && between(task, found.trial) <= 1) return;
    const bool unthinned = found.met && is_wild(task, found);
    const double tolerance = tightest(task);
    const double shown = std::max(shown_roughness(task), tolerance * tolerance);
    const bool noisy =
        noise_bound(task.samples.points) >= 0.3 * tolerance && task.samples.size() <= few_samples;
    bool calmed = false;
    for (double part : {0.1, 1.0}) {
        if (!noisy || (calmed && !is_wild(task, found))) break;
        CurveTask calmer = task;
        calmer.roughness = part * tolerance * tolerance / shown;
        CurveWithin again = refined_and_thinned(calmer, options, most);
        found.closest.see(task, again.closest);
        const bool better =
            again.met && (!found.met || between(task, again.trial) < between(task, found.trial));
        if (!better) continue;
        again.closest = found.closest;
        found = std::move(again);
        task.roughness = calmer.roughness;
        calmed = true;
    }
    if (!unthinned || calmed) return;
    thin_out(task, found); // it may be tamer with fewer knots
    found.closest.see(task, found.trial);
}

/// A curve that bends more often than the samples show is searched again, without these bends.
void take_out_inflections(const CurveTask& task, const ToleranceOptions& options, Index most,
                          CurveWithin& found) {
    if (!found.met || task.most_inflections >= 0 || !can_show_inflections(task)) return;
    const double height = visible_height(task, tightest(task));
    const Index shown = shown_inflections(task, height);
    if (curve_inflections(found.trial, height) <= shown) return;
    if (near_interpolation(found.trial.knots.free_count(), task.samples.size()))
        return; // it bends with the samples' noise
    CurveTask shaped = task;
    shaped.most_inflections = shown;
    const double strays = std::max(1.0, between(task, found.trial));
    const Index before = controls(found);
    std::optional<CurveWithin> fewest;
    const auto consider = [&](CurveWithin again) {
        if (!again.met || between(task, again.trial) > strays) return;
        if (!fewest || controls(again) < controls(*fewest)) fewest = std::move(again);
    };
    CurveWithin again = refined_further(shaped, found, most);
    if (again.met) thin_out(shaped, again);
    consider(std::move(again));
    if (before <= few_enough) // from nothing: other knots may do
        consider(refined_and_thinned(shaped, options, most));
    if (fewest) found = std::move(*fewest);
}

} // namespace

CurveWithin fewest_knots(CurveTask& task, const ToleranceOptions& options, Index most) {
    CurveWithin found = refined_and_thinned(task, options, most);
    look_beyond(task, options, most, found);
    calm_down(task, options, most, found);
    const ClosestSeen closest = found.closest;
    take_out_inflections(task, options, most, found);
    found.closest = closest;
    found.closest.see(task, found.trial);
    found.met = found.met && !is_wild(task, found);
    return found;
}

namespace {

/// Where every curve so far is too wild to be handed out: the closest on the same knots with as
/// little roughness counted as makes it acceptable.
void see_calmer(const CurveTask& task, const KnotVector& knots, ClosestSeen& closest) {
    constexpr double least = 1e-6;
    constexpr double most = 1e12;
    constexpr int rounds = 8;
    const double tolerance = tightest(task);
    const double shown = std::max(shown_roughness(task), tolerance * tolerance);
    for (double part = least; part < most && !closest.trial(); part *= 4) {
        CurveTask calmer = task;
        calmer.roughness = part * tolerance * tolerance / shown;
        const auto m = static_cast<std::size_t>(task.samples.size());
        CurveTrial trial{.knots = knots,
                         .parameters = task.parameters,
                         .weights = first_weights(task),
                         .control = {},
                         .ratio = std::vector<double>(m, 0),
                         .conflict = {}};
        settle(calmer, trial, rounds, KnotShift::none);
        closest.see(task, trial);
    }
}

} // namespace

CurveWithin closest_curve(const CurveTask& task, const ToleranceOptions& options, Index most,
                          const CurveWithin& found, double reached) {
    CurveWithin result = found;
    ClosestSeen& closest = result.closest;
    CurveTrial loosest = found.trial; // acceptable at the least loose tolerance so far, if any
    int missed = 0;                   // powers of two by which the tolerance is looser
    int met = 0;
    if (task.samples.size() <= few_samples)
        std::frexp(
            std::min({closest.worst(), reached, diagonal(task.samples.points) / tightest(task)}),
            &met);
    while (met > missed + 1) {
        const int power = (met + missed) / 2;
        const double factor = std::ldexp(1, power);
        CurveTask looser = task;
        for (double& t : looser.tolerance) t *= factor;
        const CurveWithin again = fewest_knots(looser, options, most);
        closest.see(task, again.closest, factor);
        if (again.met) loosest = rescaled(again.trial, factor);
        (again.met ? met : missed) = power;
    }
    if (!closest.trial() && !acceptable(task, loosest) && !found.trial.control.empty())
        see_calmer(task, found.trial.knots, closest);
    result.trial = closest.trial().value_or(loosest);
    result.met = closest.worst() <= 1;
    result.stages.emplace_back("closest", result.trial.knots.free_count());
    if (result.met) thin_out(task, result);
    return result;
}

CurveWithin smooth_curve(const CurveTask& task, double noise, Index most) {
    CurveTask looser = task;
    looser.fixed = fixed_samples(task);
    const double extreme = noise * (1 + std::sqrt(2 * std::log(task.samples.size())));
    for (double& t : looser.tolerance) t = std::max(t, extreme);
    CurveWithin smooth = refined(looser, most);
    if (smooth.met && task.samples.size() <= few_samples)
        thin_out(looser, smooth); // a thousand more samples per knot: nothing to gain
    CurveTrial& trial = smooth.trial;
    trial.worst = 0;
    for (std::size_t i = 0; i < trial.ratio.size(); ++i) {
        trial.ratio[i] *= looser.tolerance[i] / task.tolerance[i];
        trial.worst = std::max(trial.worst, trial.ratio[i]);
    }
    return smooth;
}

} // namespace batten
