#include <batten/search/curve_through.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <limits>
#include <span>

namespace batten {

namespace {

/// Adds the interior knots of a piece through these parameters.
void add_averaged(std::span<const double> parameters, int degree, std::vector<double>& interior) {
    if (static_cast<int>(parameters.size()) <= degree + 1) return;
    const std::vector<double> piece = interior_knots(averaged_knots(parameters, degree));
    interior.insert(interior.end(), piece.begin(), piece.end());
}

} // namespace

KnotVector knots_through(const CurveTask& task) {
    std::vector<double> t = task.parameters;
    t.erase(std::ranges::unique(t).begin(), t.end());
    const std::vector<double> lasting = lasting_knots(task);
    const bool closed = task.closure == Closure::closed;
    if (closed && lasting.empty()) return knots_at_parameters(t, task.degree);
    if (closed) t.push_back(1);
    std::vector<double> interior;
    auto from = t.begin();
    for (double corner : lasting) { // each as often as its multiplicity
        const auto to = std::ranges::find(t, corner);
        if (to > from) add_averaged(std::span(from, to + 1), task.degree, interior);
        from = std::max(from, to);
    }
    add_averaged(std::span(from, t.end()), task.degree, interior);
    const bool seam_is_corner = std::ranges::binary_search(task.corners, Index{0});
    const int agreeing = closed && !seam_is_corner ? task.seam_continuity : 0;
    for (int k = 0; k < agreeing; ++k)
        interior.push_back(k % 2 == 0 ? t[static_cast<std::size_t>(1 + k / 2)]
                                      : t[t.size() - static_cast<std::size_t>(2 + k / 2)]);
    return knots_around(task.degree, with_lasting_knots(task, std::move(interior)), t.front(),
                        closed ? 1 : t.back(), task.closure);
}

CurveWithin curve_through(const CurveTask& task) {
    CurveWithin result;
    CurveTrial& trial = result.trial;
    trial.knots = knots_through(task);
    trial.parameters = task.parameters;
    trial.weights = first_weights(task);
    trial.ratio.assign(task.parameters.size(), 0);
    trial.worst = std::numeric_limits<double>::infinity();
    if (undetermined(trial.knots, trial.parameters)) return result;
    result.met = settle(task, trial, trial_rounds, KnotShift::none) && !is_wild(task, trial);
    if (!result.met) return result;
    result.stages.emplace_back("through", trial.knots.free_count());
    if (task.samples.size() <= few_samples) thin_out(task, result);
    return result;
}

} // namespace batten
