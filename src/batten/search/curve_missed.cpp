#include <batten/search/curve_missed.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/distinct.hpp>
#include <batten/samples/samples.hpp>
#include <batten/search/curve_calmer.hpp>
#include <batten/search/curve_fewest.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace batten {

namespace {

/// Searches at looser tolerances, the same whatever was asked: powers of two of the samples' size,
/// from what was reached down to the task's, as long as they bring something closer. Returns what
/// was acceptable at the least loose of these, if any.
CurveTrial see_looser(const CurveTask& task, const ToleranceOptions& options, Index most,
                      double reached, ClosestSeen& closest) {
    constexpr int most_idle = 2; // tolerances in a row that bring nothing closer
    CurveTrial least_loose;
    double factor = diagonal(task.samples.points) / tightest(task);
    const double start = std::min({closest.worst(), reached, factor});
    while (factor > start) factor /= 2;
    for (int idle = 0; factor > 1 && idle < most_idle; factor /= 2) {
        CurveTask looser = with_tolerances(task, factor);
        const CurveWithin again = fewest_knots(looser, options, most);
        const double before = closest.worst();
        closest.see(task, again.closest, factor);
        if (again.met) least_loose = rescaled(again.trial, factor);
        idle = closest.worst() < before ? 0 : idle + 1;
    }
    return least_loose;
}

/// Adds the interior knots of a piece through these parameters.
void add_averaged(std::span<const double> parameters, int degree, std::vector<double>& interior) {
    if (static_cast<int>(parameters.size()) <= degree + 1) return;
    const std::vector<double> piece = interior_knots(averaged_knots(parameters, degree));
    interior.insert(interior.end(), piece.begin(), piece.end());
}

/// Those of every piece from one cut to the next, all of them parameters.
std::vector<double> averaged_between(std::vector<double> cuts, std::vector<double> t,
                                     const CurveTask& task) {
    if (task.closure == Closure::open) {
        cuts.insert(cuts.begin(), t.front());
        cuts.push_back(t.back());
    } else { // the last piece goes on to the first cut
        cuts.push_back(cuts.front() + 1);
        for (std::size_t i = 0, once = t.size(); i < once; ++i) t.push_back(t[i] + 1);
    }
    std::vector<double> interior;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const auto from = std::ranges::lower_bound(t, cuts[k]);
        const auto to = std::ranges::upper_bound(t, cuts[k + 1]);
        add_averaged(std::span(from, to), task.degree, interior);
    }
    for (double& x : interior)
        if (task.closure == Closure::closed) x -= std::floor(x);
    std::ranges::sort(interior);
    return interior;
}

/// A closed curve's seam takes knots of its own: a free one that next to it, a held one as many
/// more as derivatives agree there.
void fit_seam(const CurveTask& task, const std::vector<double>& t, std::vector<double>& interior) {
    const bool held = std::ranges::binary_search(lasting_knots(task), 0.0);
    if (!held && !interior.empty()) {
        const bool first = interior.front() < 1 - interior.back();
        interior.erase(first ? interior.begin() : interior.end() - 1);
    }
    const int agreeing = held && !seam_is_corner(task) ? task.seam_continuity : 0;
    for (int k = 0; k < agreeing; ++k) {
        const auto i = static_cast<std::size_t>(k / 2);
        const std::size_t last = t.size() - 1 - i;
        interior.push_back(k % 2 == 0 ? (t[i] + t[i + 1]) / 2
                                      : (t[last] + (i == 0 ? 1 : t[last + 1])) / 2);
    }
}

} // namespace

bool may_go_through(const CurveTask& task, const ToleranceOptions& options) {
    return options.max_control_points == 0 || options.max_control_points >= task.samples.size();
}

CurveWithin closest_curve(const CurveTask& task, const ToleranceOptions& options, Index most,
                          const CurveWithin& found, double reached) {
    CurveWithin result = found;
    ClosestSeen& closest = result.closest;
    CurveTrial least_loose;
    if (task.samples.size() <= few_samples) {
        least_loose = see_looser(task, options, most, reached, closest);
        if (!found.trial.control.empty()) see_calmer(task, found.trial.knots, closest);
        const auto through = knots_through(task);
        if (through && may_go_through(task, options)) see_calmer(task, *through, closest);
    }
    if (least_loose.control.empty()) least_loose = found.trial;
    result.trial = closest.trial().value_or(least_loose);
    result.met = closest.worst() <= 1;
    result.stages.emplace_back("closest", result.trial.knots.free_count());
    if (result.met) thin_out(task, result);
    return result;
}

std::optional<KnotVector> knots_through(const CurveTask& task) {
    const bool closed = task.closure == Closure::closed;
    std::vector<double> t = without_repeats(task.parameters);
    if (closed && t.back() >= 1) t.pop_back(); // the first sample's place once more
    const std::vector<double> cuts = without_repeats(lasting_knots(task));
    if (closed && cuts.empty()) return knots_at_parameters(t, task.degree);
    if (!std::ranges::includes(t, cuts)) return {};
    std::vector<double> interior = averaged_between(cuts, t, task);
    if (closed) fit_seam(task, t, interior);
    KnotVector knots = knots_around(task.degree, with_lasting_knots(task, std::move(interior)),
                                    closed ? 0 : t.front(), closed ? 1 : t.back(), task.closure);
    if (knots.free_count() != static_cast<Index>(t.size()) || undetermined(knots, t)) return {};
    return knots;
}

CurveWithin curve_through(const CurveTask& task) {
    CurveWithin result;
    const auto knots = knots_through(task);
    if (!knots) return result;
    result.trial = first_trial(task, *knots);
    result.met =
        settle(task, result.trial, trial_rounds, KnotShift::none) && !is_wild(task, result.trial);
    if (!result.met) return result;
    result.stages.emplace_back("through", result.trial.knots.free_count());
    if (task.samples.size() <= few_samples) thin_out(task, result);
    return result;
}

} // namespace batten
