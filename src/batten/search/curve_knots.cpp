#include <batten/search/curve_knots.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/measure/between_samples.hpp>
#include <batten/samples/samples.hpp>
#include <batten/search/search.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <utility>

namespace batten {

std::vector<double> first_weights(const CurveTask& task) {
    const double smallest = tightest(task);
    std::vector<double> weights;
    for (std::size_t i = 0; i < task.tolerance.size(); ++i) {
        const double part = smallest / task.tolerance[i];
        weights.push_back(part * part *
                          (task.samples.weights.empty() ? 1.0 : task.samples.weights[i]));
    }
    return weights;
}

CurveTrial first_trial(const CurveTask& task, KnotVector knots) {
    return {.knots = std::move(knots),
            .parameters = task.parameters,
            .weights = first_weights(task),
            .control = {},
            .ratio = std::vector<double>(task.parameters.size(), 0),
            .conflict = {}};
}

std::vector<double> interior_knots(const KnotVector& knots) {
    const auto all = knots.knots();
    const auto p = static_cast<std::size_t>(knots.degree());
    const auto n = static_cast<std::size_t>(knots.control_count());
    return {all.begin() + static_cast<Index>(p) + 1, all.begin() + static_cast<Index>(n)};
}

KnotVector with_interior(const CurveTask& task, const KnotVector& old,
                         const std::vector<double>& interior) {
    return knots_around(task.degree, interior, old.begin(), old.end(), task.closure);
}

bool seam_is_corner(const CurveTask& task) {
    return task.closure == Closure::closed && std::ranges::binary_search(task.corners, Index{0});
}

std::vector<double> lasting_knots(const CurveTask& task) {
    std::vector<double> result;
    const bool closed = task.closure == Closure::closed;
    if (closed && !seam_is_corner(task)) // one of the seam's knots is there by itself
        for (int k = task.seam_continuity; k + 1 < task.degree; ++k) result.push_back(0);
    for (Index i : task.corners) {
        const bool seam = closed && i == 0;
        result.insert(result.end(), static_cast<std::size_t>(task.degree - (seam ? 1 : 0)),
                      task.parameters[static_cast<std::size_t>(i)]);
    }
    std::ranges::sort(result);
    return result;
}

std::size_t free_knots(const CurveTask& task, const CurveTrial& trial) {
    const std::size_t all = interior_knots(trial.knots).size();
    return all - std::min(all, lasting_knots(task).size()); // some of these may have been taken out
}

bool makes_curve(const CurveTask& task, const std::vector<double>& interior) {
    return task.closure == Closure::open || static_cast<int>(interior.size()) >= task.degree;
}

std::vector<double> with_lasting_knots(const CurveTask& task, std::vector<double> interior) {
    const std::vector<double> lasting = lasting_knots(task);
    for (double t : lasting) std::erase(interior, t);
    interior.insert(interior.end(), lasting.begin(), lasting.end());
    std::ranges::sort(interior);
    return interior;
}

KnotVector first_knots(const CurveTask& task) {
    if (task.closure == Closure::open)
        return knots_around(task.degree, with_lasting_knots(task, {}), task.parameters.front(),
                            task.parameters.back());
    const auto m = static_cast<Index>(task.parameters.size());
    KnotVector knots;
    for (Index n = std::min<Index>(2 * task.degree + 2, m - 1); n > task.degree; --n) {
        const KnotVector spread =
            knots_from_parameters(task.parameters, task.degree, n, Closure::closed);
        knots = knots_around(task.degree, with_lasting_knots(task, interior_knots(spread)), 0, 1,
                             Closure::closed);
        if (!undetermined(knots, task.parameters)) break;
    }
    return knots;
}

double between(const CurveTask& task, const CurveTrial& trial) {
    return check_between(spline_of(trial), task.samples.points, trial.parameters, task.tolerance)
        .excess;
}

bool is_wild(const CurveTask& task, const CurveTrial& trial, double looser) {
    std::vector<double> judged = task.tolerance;
    const double least = unseen * diagonal(task.samples.points);
    for (double& t : judged) t = std::max(t * looser, least);
    return check_between(spline_of(trial), task.samples.points, trial.parameters, judged).excess >
           wild_part;
}

} // namespace batten
