#include <batten/search/curve_fewest.hpp>

#include <batten/samples/corners.hpp>
#include <batten/samples/noise.hpp>
#include <batten/samples/samples.hpp>
#include <batten/search/curve_calmer.hpp>
#include <batten/search/curve_corners.hpp>
#include <batten/search/curve_exchange.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/curve_rising.hpp>
#include <batten/search/curve_verdict.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace batten {

namespace {

constexpr Index few_enough = 40; // control points for which a second search takes little time
constexpr Index squeezed_samples = 500; // at most: doing it all again costs many passes over them

/// Refines without corners and with them: what took fewer control points, or came nearer.
CurveWithin refined_with_corners(CurveTask& task, const ToleranceOptions& options, Index most) {
    task.fixed = fixed_samples(task);
    CurveWithin best = refined(task, most);
    if (options.corners == Corners::automatic) {
        CurveTask cornered = task;
        cornered.corners = spaced_corners(
            task.sharp ? *task.sharp : find_corners(task.samples.points, task.closure), task);
        const bool allowed =
            !cornered.corners.empty() && first_knots(cornered).free_count() <= most;
        if (allowed) {
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

/// The fewest control points from one search: refined and thinned out, or risen.
CurveWithin refined_and_thinned(CurveTask& task, const ToleranceOptions& options, Index most) {
    const bool few = task.samples.size() <= few_samples;
    CurveWithin best = refined_with_corners(task, options, most);
    if (few) rise_instead(task, most, best);
    // what is wild is searched again before anything is taken out
    if (!best.met || (task.roughness == 0 && is_wild(task, best.trial))) return best;
    thin_out(task, best);
    if (few) rise_below(task, best);
    return best;
}

/// Takes what a search for tighter tolerances finds, squeezed, where it has fewer control points.
/// Returns how many it has; 0 where those were not met.
Index squeeze_tighter(CurveTask& task, std::vector<double> tolerance,
                      const ToleranceOptions& options, Index most, CurveWithin& best) {
    CurveTask tighter = task;
    tighter.tolerance = std::move(tolerance);
    CurveWithin again =
        refined_and_thinned(tighter, options, std::min(most, controls(best) * 3 / 2 + 10));
    if (!again.met) return 0;
    again.trial = rescaled(again.trial, tighter.tolerance, task.tolerance);
    const bool tame = between(task, again.trial) <= std::max(1.0, between(task, best.trial));
    if (tame) squeeze(task, again);
    const Index took = controls(again);
    if (tame && took < controls(best)) {
        again.closest = best.closest;
        best = std::move(again);
        task.corners = std::move(tighter.corners);
        task.fixed = std::move(tighter.fixed);
    }
    return took;
}

/// Squeezes a met fit and those for tighter tolerances, as long as these take hardly more control
/// points: first for the smallest everywhere.
void squeeze_further(CurveTask& task, const ToleranceOptions& options, Index most,
                     CurveWithin& best) {
    const bool few = samples_in_all(task) <= squeezed_samples;
    const auto worthwhile = [&] { return best.met && controls(best) <= few_enough; };
    if (!worthwhile() || (!few && (task.stand_for == 0 || task.samples.size() > few_samples)))
        return;
    squeeze(task, best);
    if (!few) return;
    const double smallest = tightest(task);
    if (std::ranges::any_of(task.tolerance, [&](double t) { return t > smallest; }))
        squeeze_tighter(task, std::vector<double>(task.tolerance.size(), smallest), options, most,
                        best);
    constexpr double least = 0.005; // part of the tolerance
    for (double part = 0.3; part > least && worthwhile(); part *= 0.3) {
        const Index took =
            squeeze_tighter(task, with_tolerances(task, part).tolerance, options, most, best);
        if (took == 0 || 5 * took > 6 * controls(best)) return;
    }
}

/// Where knots stand nearly as close as samples, a curve may be within the tolerance and wild
/// between them: the search is done again with a little roughness counted, such that what the
/// samples show of it costs a small part of the tolerance.
void calm_down(CurveTask& task, const ToleranceOptions& options, Index most, CurveWithin& found) {
    if (!found.trial.control.empty() && found.met && between(task, found.trial) <= 1) return;
    const bool unthinned = found.met && is_wild(task, found.trial);
    const bool noisy = noise_bound(task.samples.points) >= 0.3 * tightest(task) &&
                       task.samples.size() <= few_samples;
    bool calmed = false;
    for (double part : {0.1, 1.0}) {
        if (!noisy || (calmed && !is_wild(task, found.trial))) break;
        CurveTask with_roughness = calmer(task, part);
        CurveWithin again = refined_and_thinned(with_roughness, options, most);
        found.closest.see(task, again.closest);
        const bool better =
            again.met && (!found.met || between(task, again.trial) < between(task, found.trial));
        if (!better) continue;
        again.closest = found.closest;
        found = std::move(again);
        task.roughness = with_roughness.roughness;
        calmed = true;
    }
    if (!unthinned || calmed) return;
    thin_out(task, found); // it may be tamer with fewer knots
    found.closest.see(task, found.trial);
}

/// Looks for a curve in place of one that bends more often than the samples show.
class WithoutBends {
  public:
    WithoutBends(const CurveTask& task, const ToleranceOptions& options, Index most,
                 const CurveWithin& found)
        : task_(task),
          options_(options),
          found_(found),
          height_(visible_height(task, tightest(task))),
          shown_(shown_inflections(task, height_)),
          quick_(samples_in_all(task) <= squeezed_samples),
          before_(controls(found)),
          worth_(std::min(most, before_ + std::max<Index>(before_ / 4, 4))),
          refining_(std::min(most, 2 * worth_ + 10)),
          strays_(std::max(1.0, between(task, found.trial))) {}

    /// Whether the curve bends more often, and not with the samples' noise.
    bool wanted() const {
        return curve_inflections(found_.trial, height_) > shown_ &&
               !near_interpolation(before_, task_.samples.size());
    }

    /// The one of fewest control points, where there is one.
    std::optional<CurveWithin> fewest() {
        CurveTask shaped = task_;
        limit_inflections(shaped, shown_);
        further(shaped);
        if (before_ > few_enough) return std::move(fewest_);
        from_nothing(shaped);
        if (quick_) closer();
        return std::move(fewest_);
    }

  private:
    /// From the knots of the curve that bends.
    void further(const CurveTask& shaped) {
        CurveWithin again = refined_further(shaped, found_, refining_);
        if (again.met) thin_out(shaped, again);
        consider(std::move(again));
    }

    /// Other knots may do.
    void from_nothing(CurveTask& shaped) {
        CurveWithin again = refined_and_thinned(shaped, options_, refining_);
        if (again.met && quick_) squeeze(shaped, again);
        consider(std::move(again));
    }

    /// Closer to the samples it may bend as they do by itself.
    void closer() {
        for (double part : {0.5, 0.3, 0.1}) {
            if (fewest_ && controls(*fewest_) <= before_) return;
            CurveTask tighter = with_tolerances(task_, part);
            CurveWithin again = refined_and_thinned(tighter, options_, worth_);
            if (again.met) squeeze(tighter, again);
            if (!again.met || curve_inflections(again.trial, height_) > shown_) continue;
            again.trial = rescaled(std::move(again.trial), part);
            consider(std::move(again));
        }
    }

    void consider(CurveWithin again) {
        if (!again.met || controls(again) > worth_ || between(task_, again.trial) > strays_) return;
        if (!fewest_ || controls(again) < controls(*fewest_)) fewest_ = std::move(again);
    }

    const CurveTask& task_;
    const ToleranceOptions& options_;
    const CurveWithin& found_;
    double height_;
    Index shown_;
    bool quick_;
    Index before_;
    Index worth_;    ///< control points: beyond it the bends may stay
    Index refining_; ///< what is refined is thinned out to half as many and fewer
    double strays_;
    std::optional<CurveWithin> fewest_;
};

/// A curve that bends more often than the samples show is searched again, without these bends.
void take_out_inflections(const CurveTask& task, const ToleranceOptions& options, Index most,
                          CurveWithin& found) {
    if (!found.met || task.most_inflections >= 0 || !can_show_inflections(task)) return;
    WithoutBends search(task, options, most, found);
    if (!search.wanted()) return;
    if (std::optional<CurveWithin> calm = search.fewest()) found = std::move(*calm);
}

} // namespace

CurveWithin fewest_knots(CurveTask& task, const ToleranceOptions& options, Index most) {
    CurveWithin found = refined_and_thinned(task, options, most);
    squeeze_further(task, options, most, found);
    calm_down(task, options, most, found);
    const ClosestSeen closest = found.closest;
    take_out_inflections(task, options, most, found);
    found.closest = closest;
    found.closest.see(task, found.trial);
    found.met = found.met && !is_wild(task, found.trial);
    return found;
}

CurveWithin smooth_curve(const CurveTask& task, double noise, Index most) {
    CurveTask looser = task;
    looser.fixed = fixed_samples(task);
    const double extreme = noise * (1 + std::sqrt(2 * std::log(task.samples.size())));
    for (double& t : looser.tolerance) t = std::max(t, extreme);
    CurveWithin smooth = by_exchange(looser, most, refined);
    if (smooth.met && task.samples.size() <= few_samples)
        thin_out(looser, smooth); // a thousand more samples per knot: nothing to gain
    smooth.trial = rescaled(smooth.trial, looser.tolerance, task.tolerance);
    return smooth;
}

} // namespace batten
