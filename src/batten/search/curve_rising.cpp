#include <batten/search/curve_rising.hpp>

#include <batten/search/curve_knots.hpp>
#include <batten/search/curve_spread.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// Settles the trial on so many free knots, spread by its curve; false where the samples do not
/// determine the control points.
bool settle_on(const CurveTask& task, CurveTrial& trial, std::size_t count, int smoothing,
               int rounds, KnotShift shift) {
    if (!trial.control.empty()) {
        const std::vector<double> interior =
            with_lasting_knots(task, spread(task, trial, count, smoothing));
        if (!makes_curve(task, interior)) return false;
        trial.knots = with_interior(task, trial.knots, interior);
    }
    trial.weights = first_weights(task);
    if (undetermined(trial.knots, trial.parameters)) return false;
    settle(task, trial, rounds, shift, Effort::thorough);
    return std::isfinite(trial.worst);
}

bool is_good(const CurveTask& task, const CurveTrial& trial) {
    return trial.worst <= 1 && between(task, trial) <= task.between;
}

/// Another way to few knots than refining and thinning out: from the fewest upwards, at most `most`
/// control points, spread anew each time (`smoothing` as in search/curve_spread.hpp), the samples'
/// parameters following the curve from one count to the next. `met` when every sample is within
/// tolerance and the curve strays no further between them than CurveTask::between allows. Bounded
/// in trials.
CurveWithin risen(const CurveTask& task, Index most, int smoothing) {
    constexpr int most_idle = 4; // counts in a row that hardly bring the curve nearer
    CurveWithin result;
    CurveTrial& good = result.trial;
    CurveTrial trial = first_trial(task, first_knots(task));
    std::size_t missed = free_knots(task, trial);
    std::size_t met = missed;
    double nearest = std::numeric_limits<double>::infinity();
    for (int idle = 0;;) {
        CurveTrial attempt = trial;
        if (!settle_on(task, attempt, met, smoothing, trial_rounds, KnotShift::none) ||
            attempt.knots.free_count() > most)
            return result;
        result.closest.see(task, attempt);
        idle = attempt.worst < 0.9 * nearest ? 0 : idle + 1;
        nearest = std::min(nearest, attempt.worst);
        result.met = is_good(task, attempt);
        (result.met ? good : trial) = std::move(attempt);
        if (result.met) break;
        if (idle > most_idle) return result;
        missed = met;
        met += 1 + met / 8;
    }
    while (met > missed + 1) {
        const std::size_t count = (met + missed) / 2;
        CurveTrial attempt = trial;
        const bool settled =
            settle_on(task, attempt, count, smoothing, trial_rounds, KnotShift::none);
        const bool within = settled && is_good(task, attempt);
        (within ? met : missed) = count;
        if (settled) (within ? good : trial) = std::move(attempt);
    }
    result.stages.emplace_back("risen", good.knots.free_count());
    return result;
}

} // namespace

void rise_below(const CurveTask& task, CurveWithin& best) {
    for (int smoothing : {evenly, 12}) {
        CurveWithin again = risen(task, controls(best) - 1, smoothing);
        if (!again.met) continue;
        again.closest = best.closest;
        best = std::move(again);
    }
}

void rise_instead(const CurveTask& task, Index most, CurveWithin& best) {
    if (best.met && !is_wild(task, best.trial)) return;
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

void squeeze(const CurveTask& task, CurveWithin& fit) {
    constexpr int rounds = 2 * trial_rounds;
    CurveTrial& trial = fit.trial;
    const auto spread_on_one_less = [&] {
        const std::size_t count = free_knots(task, trial);
        for (int smoothing : {evenly, 12, 1}) {
            if (count == 0) return false;
            CurveTrial attempt = trial;
            if (!settle_on(task, attempt, count - 1, smoothing, rounds, KnotShift::allowed) ||
                !is_good(task, attempt))
                continue;
            trial = std::move(attempt);
            return true;
        }
        return false;
    };
    const auto thinned_by_one = [&] {
        const Index before = trial.knots.free_count();
        thin_one_by_one(task, trial);
        return trial.knots.free_count() < before;
    };
    while (spread_on_one_less() || thinned_by_one()) {
    }
    fit.stages.emplace_back("squeezed", trial.knots.free_count());
}

} // namespace batten
