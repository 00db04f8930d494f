#include <batten/search/curve_refining.hpp>

#include <batten/search/curve_knots.hpp>
#include <batten/search/curve_spread.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// How much each interior knot matters: the jump of the highest derivative across it times the cube
/// (degree 3) of its spans.
std::vector<double> knot_significance(const CurveTask& task, const CurveTrial& trial,
                                      const std::vector<double>& interior) {
    std::vector<double> result;
    const KnotVector& k = trial.knots;
    const Spline spline = spline_of(trial);
    for (std::size_t j = 0; j < interior.size(); ++j) {
        const Index at = static_cast<Index>(j) + k.degree() + 1;
        const double left = k[at] - k[at - 1];
        const double right = k[at + 1] - k[at];
        if (!(left > 0) || !(right > 0)) { // part of a corner
            result.push_back(std::numeric_limits<double>::max());
            continue;
        }
        const std::array order{task.degree};
        const auto before = spline(std::array{k[at] - left / 2}, order);
        const auto after = spline(std::array{k[at] + right / 2}, order);
        result.push_back(distance(before, after) *
                         std::pow(left * right / (left + right), task.degree));
    }
    return result;
}

/// Tries the trial without some of its knots.
bool without(const CurveTask& task, CurveTrial& trial, const std::vector<double>& interior,
             int rounds) {
    if (!makes_curve(task, interior)) return false;
    CurveTrial attempt = trial;
    attempt.knots = with_interior(task, trial.knots, interior);
    attempt.weights = first_weights(task);
    if (undetermined(attempt.knots, attempt.parameters)) return false;
    if (!settle(task, attempt, rounds, KnotShift::allowed)) return false;
    if (between(task, attempt) > task.between) return false;
    trial = std::move(attempt);
    return true;
}

/// Spreads fewer and fewer knots anew, by bisection, as long as the tolerance is met; each way of
/// spreading in turn.
void spread_out(const CurveTask& task, CurveTrial& trial) {
    const CurveTrial source = trial;
    for (int smoothing : {1, 12, evenly}) {
        std::size_t met = free_knots(task, trial);
        std::size_t missed =
            static_cast<std::size_t>(task.closure == Closure::closed ? task.degree : 0);
        while (met > missed + 1) {
            const std::size_t count = (met + missed) / 2;
            const std::vector<double> interior =
                with_lasting_knots(task, spread(task, source, count, smoothing));
            CurveTrial attempt = source;
            attempt.parameters = task.parameters;
            bool good = without(task, attempt, interior, trial_rounds);
            if (!good) {
                attempt = source;
                good = without(task, attempt, interior, trial_rounds);
            }
            if (good) {
                trial = std::move(attempt);
                met = count;
            } else {
                missed = count;
            }
        }
    }
}

/// Positions of the interior knots, the least significant first.
std::vector<std::size_t> by_significance(const CurveTask& task, const CurveTrial& trial,
                                         const std::vector<double>& interior) {
    const std::vector<double> significance = knot_significance(task, trial, interior);
    std::vector<std::size_t> order(interior.size());
    for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return significance[a] < significance[b];
    });
    return order;
}

/// Takes out ever smaller batches of the least significant knots.
void thin_in_batches(const CurveTask& task, CurveTrial& trial) {
    for (std::size_t batch = interior_knots(trial.knots).size() / 4; batch > 1;) {
        const std::vector<double> interior = interior_knots(trial.knots);
        if (interior.empty()) return;
        const std::vector<std::size_t> order = by_significance(task, trial, interior);
        std::vector<bool> out(interior.size(), false);
        for (std::size_t k = 0; k < std::min(batch, order.size()); ++k) out[order[k]] = true;
        std::vector<double> rest;
        for (std::size_t j = 0; j < interior.size(); ++j)
            if (!out[j]) rest.push_back(interior[j]);
        if (!without(task, trial, rest, trial_rounds)) batch /= 2;
    }
}

bool is_lasting(const CurveTask& task, double knot) {
    const std::vector<double> lasting = lasting_knots(task);
    return std::ranges::binary_search(lasting, knot);
}

} // namespace

void thin_one_by_one(const CurveTask& task, CurveTrial& trial) {
    std::vector<bool> needed(interior_knots(trial.knots).size(), false);
    for (bool any = true; any;) {
        any = false;
        const std::vector<double> interior = interior_knots(trial.knots);
        for (std::size_t j : by_significance(task, trial, interior)) {
            if (needed[j]) continue;
            std::vector<double> rest = interior;
            rest.erase(rest.begin() + static_cast<Index>(j));
            bool gone = without(task, trial, rest, trial_rounds);
            if (!gone && j < rest.size() &&
                interior[j] < rest[j]) { // two knots made one between them
                rest[j] = (interior[j] + rest[j]) / 2;
                gone = !is_lasting(task, interior[j]) && !is_lasting(task, interior[j + 1]) &&
                       without(task, trial, rest, trial_rounds);
            }
            if (!gone) {
                needed[j] = true;
                continue;
            }
            needed.erase(needed.begin() + static_cast<Index>(j));
            for (std::size_t near = j > 3 ? j - 3 : 0; near < std::min(needed.size(), j + 3);
                 ++near)
                needed[near] = false;
            any = true;
            break;
        }
    }
}

void thin_out(const CurveTask& given, CurveWithin& fit) {
    CurveTask task = given;
    CurveTrial& trial = fit.trial;
    // where the samples themselves go back and forth no curve is within 1; what is wild gets tame
    task.between = std::clamp(between(task, trial), 1.0, wild_part);
    spread_out(task, trial);
    fit.stages.emplace_back("spread", trial.knots.free_count());
    thin_in_batches(task, trial);
    constexpr Index many = 400; // control points: then each costs more time than it is worth
    if (trial.knots.free_count() <= many) thin_one_by_one(task, trial);
    fit.stages.emplace_back("thinned", trial.knots.free_count());
}

} // namespace batten
