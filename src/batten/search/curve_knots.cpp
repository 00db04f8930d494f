#include <batten/search/curve_knots.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/measure/between_samples.hpp>

#include <algorithm>

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

std::vector<double> lasting_knots(const CurveTask& task) {
    std::vector<double> result;
    const bool closed = task.closure == Closure::closed;
    const bool seam_is_corner = closed && std::ranges::binary_search(task.corners, Index{0});
    if (closed && !seam_is_corner) // one of the seam's knots is there by itself
        for (int k = task.seam_continuity; k + 1 < task.degree; ++k) result.push_back(0);
    for (Index i : task.corners) {
        const bool seam = closed && i == 0;
        result.insert(result.end(), static_cast<std::size_t>(task.degree - (seam ? 1 : 0)),
                      task.parameters[static_cast<std::size_t>(i)]);
    }
    std::ranges::sort(result);
    return result;
}

std::vector<double> with_lasting_knots(const CurveTask& task, std::vector<double> interior) {
    const std::vector<double> lasting = lasting_knots(task);
    for (double t : lasting) std::erase(interior, t);
    interior.insert(interior.end(), lasting.begin(), lasting.end());
    std::ranges::sort(interior);
    return interior;
}

double between(const CurveTask& task, const CurveTrial& trial) {
    return check_between(spline_of(trial), task.samples.points, trial.parameters, task.tolerance)
        .excess;
}

} // namespace batten
