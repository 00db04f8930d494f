#include <batten/search/curve_refining.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/measure/between_samples.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// New knots for every span that holds samples out of tolerance: at the centre of their squared
/// excess.
std::vector<double> knots_where_the_error_is(const CurveTask& task, const CurveTrial& trial,
                                             double least = 1) {
    const std::vector<double> breaks = trial.knots.breakpoints();
    std::vector<double> fresh;
    std::size_t i = 0;
    const std::size_t m = trial.parameters.size();
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
        double mass = 0;
        double moment = 0;
        double worst = 0;
        double worst_at = 0;
        std::size_t count = 0;
        for (; i < m && (trial.parameters[i] < breaks[b + 1] || b + 2 == breaks.size());
             ++i, ++count) {
            const double r = trial.ratio[i];
            mass += r * r;
            moment += r * r * trial.parameters[i];
            if (r > worst) {
                worst = r;
                worst_at = trial.parameters[i];
            }
        }
        if (worst <= least) continue;
        const double length = breaks[b + 1] - breaks[b];
        double at = moment / mass;
        // few samples and one far out: the knot goes next to that one
        if (count <= static_cast<std::size_t>(task.degree) + 1 && worst > 4) at = worst_at;
        at = std::clamp(at, breaks[b] + 0.05 * length, breaks[b + 1] - 0.05 * length);
        fresh.push_back(at);
    }
    return fresh;
}

/// Adds knots one by one as long as the samples determine the control points; false when none could
/// be added.
bool refine(const CurveTask& task, CurveTrial& trial, const std::vector<double>& fresh,
            Index most) {
    std::vector<double> interior = interior_knots(trial.knots);
    bool any = false;
    for (double t : fresh) {
        if (static_cast<Index>(interior.size()) + task.degree + 1 >= most) break;
        if (std::ranges::count(interior, t) >= task.degree) continue;
        std::vector<double> longer = interior;
        longer.insert(std::upper_bound(longer.begin(), longer.end(), t), t);
        const KnotVector knots = with_interior(task, trial.knots, longer);
        if (undetermined(knots, trial.parameters)) continue;
        interior = std::move(longer);
        any = true;
    }
    if (any) trial.knots = with_interior(task, trial.knots, interior);
    return any;
}

/// Where the curve strays between two samples: knots there, until it does not, or as before when
/// that does not help. Returns what part it then uses of what is allowed between samples.
double calm(const CurveTask& task, CurveTrial& trial, Index most, ClosestSeen& closest) {
    constexpr int most_tries = 12;
    CurveTrial attempt = trial;
    double strays = 0; // of `trial`
    for (int tries = 0; tries < most_tries; ++tries) {
        const BetweenSamples worst = check_between(spline_of(attempt), task.samples.points,
                                                   attempt.parameters, task.tolerance);
        if (tries == 0) strays = worst.excess;
        if (worst.good) {
            trial = std::move(attempt);
            return worst.excess;
        }
        const auto a = static_cast<std::size_t>(worst.worst_sample);
        const bool seam = a + 1 == attempt.parameters.size();
        const double from = attempt.parameters[a];
        const double to = seam ? attempt.knots.end() : attempt.parameters[a + 1];
        // a knot to either side: the stretch between the samples gets a piece of its own
        const double width = std::max(to - from, 1e-6 * attempt.knots.length());
        if (!refine(task, attempt,
                    {std::max(from - width / 2, attempt.knots.begin() + width / 4),
                     std::min(to + width / 2, attempt.knots.end() - width / 4)},
                    most))
            break;
        attempt.parameters = task.parameters;
        attempt.weights = first_weights(task);
        if (!settle(task, attempt, 6, KnotShift::none)) {
            closest.see(task, attempt);
            if (!refine(task, attempt, knots_where_the_error_is(task, attempt), most)) break;
            settle(task, attempt, 6, KnotShift::none);
        }
        closest.see(task, attempt);
        if (attempt.worst > 1) break;
    }
    return strays;
}

/// One way of refining: from which parameters each round starts, how long it tries, which spans get
/// a knot.
struct Refinement {
    enum class From { samples, last_round } from;
    int rounds;
    double least; ///< part of the largest distance that a span must hold to get a knot; at least
                  ///< the tolerance
};

/// Refines until the tolerance is met, or the round that came nearest.
CurveTrial refine_by(const Refinement& way, const CurveTask& task, Index most,
                     ClosestSeen& closest) {
    constexpr int most_rounds = 60;
    CurveTrial trial = first_trial(task, first_knots(task));
    CurveTrial best;
    best.worst = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
        trial.weights = first_weights(task);
        const CurveTrial before = trial;
        if (way.from == Refinement::From::samples) trial.parameters = task.parameters;
        const bool met = settle(task, trial, way.rounds, KnotShift::none);
        if (trial.worst < best.worst) best = trial;
        closest.see(task, trial);
        if (met) break;
        if (!std::isfinite(trial.worst)) {
            const std::vector<double> marked = trial.ratio;
            best.conflict = trial.conflict;
            trial = before;
            trial.ratio = marked;
        }
        if (!refine(task, trial,
                    knots_where_the_error_is(task, trial, std::max(1.0, way.least * trial.worst)),
                    most) &&
            !refine(task, trial, knots_where_the_error_is(task, trial, 1), most))
            break;
    }
    if (std::isfinite(best.worst) && best.worst > 1)
        settle(task, best, 3 * trial_rounds, KnotShift::allowed);
    closest.see(task, best);
    return best;
}

} // namespace

CurveWithin refined(const CurveTask& task, Index most) {
    using From = Refinement::From;
    CurveWithin result;
    result.trial.worst = std::numeric_limits<double>::infinity();
    double least_straying = std::numeric_limits<double>::infinity();
    // near interpolation the rounds are sensitive to every choice: then other ways are tried
    for (const Refinement& way : {Refinement{From::samples, 3, 0},
                                  {From::last_round, trial_rounds, 0},
                                  {From::samples, trial_rounds, 0.5},
                                  {From::last_round, 6, 0.5}}) {
        CurveTrial trial = refine_by(way, task, most, result.closest);
        const bool met = trial.worst <= 1;
        const double strays =
            met ? calm(task, trial, most, result.closest) : std::numeric_limits<double>::infinity();
        const bool better = met != result.met ? met
                            : met             ? strays < least_straying
                                              : trial.worst < result.trial.worst;
        if (better || result.trial.parameters.empty()) {
            result.trial = std::move(trial);
            result.met = met;
            least_straying = strays;
        }
        if ((result.met && least_straying <= 1) || task.samples.size() > few_samples) break;
    }
    result.stages.emplace_back("refined", result.trial.knots.free_count());
    return result;
}

CurveWithin refined_further(const CurveTask& task, const CurveWithin& fit, Index most) {
    constexpr int most_rounds = 8;
    CurveWithin result = fit;
    CurveTrial& trial = result.trial;
    for (int round = 0; round < most_rounds; ++round) {
        trial.weights = first_weights(task);
        result.met = settle(task, trial, 6, KnotShift::none);
        if (result.met || !std::isfinite(trial.worst)) break;
        if (!refine(task, trial, knots_where_the_error_is(task, trial), most)) break;
    }
    result.stages.emplace_back("reshaped", trial.knots.free_count());
    return result;
}

} // namespace batten
