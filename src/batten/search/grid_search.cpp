#include <batten/core/grid_index.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/problem/plan.hpp>
#include <batten/search/grid_exchange.hpp>
#include <batten/search/grid_trials.hpp>
#include <batten/search/search.hpp>
#include <batten/search/verdict_words.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// Greatest number of control points along each axis, so that together they are at most `part` of
/// the samples.
std::vector<Index> most_per_axis(const Problem& problem, double part) {
    const std::vector<int>& degree = problem.axes.degree;
    const double share = std::pow(part, 1 / static_cast<double>(degree.size()));
    std::vector<Index> most;
    for (std::size_t k = 0; k < degree.size(); ++k)
        most.push_back(
            std::max<Index>(degree[k] + 1, static_cast<Index>(share * samples_along(problem, k))));
    return most;
}

/// The fewest control points, with the certificate of a grid.
GridWithin certified(const GridTask& task) {
    GridWithin found = sizes_by_exchange(task);
    if (found.spline.axis_count() > 0 && !task.parameters.is_scattered())
        found.between = check_reached(task, found.spline, found.worst);
    return found;
}

/// The search; once more with what lies between the samples counted where the spline is wild there.
GridWithin searched(const GridTask& task) {
    GridWithin found = certified(task);
    if (found.between.excess <= wild_part) return found;
    GridTask calmer = task;
    calmer.between = GridTask::Between::counted;
    GridWithin calm = certified(calmer);
    return calm.spline.axis_count() > 0 ? calm : found;
}

NotMet why_not(const GridTask& task, const GridWithin& found, Index allowed) {
    const Index n = GridIndex(free_shape(found.spline.axes())).size();
    if (found.worst <= 1) return NotMet::wild;
    if (task.hold.equalities() && n < GridIndex(task.most).size() / 2) return NotMet::held;
    return allowed > 0 ? NotMet::limited : NotMet::crowded;
}

/// The account of a search: the certificate, the verdict and the ending; `allowed`: control points,
/// where a limit was stated.
FitReport judged(const GridTask& task, const GridWithin& found, Index allowed, double deviation,
                 double unit) {
    FitReport report;
    const Index n = GridIndex(free_shape(found.spline.axes())).size();
    const BetweenSamples& between = found.between;
    const bool met = found.met && between.excess <= wild_part;
    report.stages = found.stages;
    report.searched_samples = found.searched;
    report.full_checks = found.full_checks;
    report.tolerance = *std::ranges::min_element(task.tolerance);
    report.termination = met ? Termination::tolerance_met : Termination::tolerance_not_met;
    report.between_samples = between.excess;
    report.verdict = met ? "met"
                         : not_met_words({.why = why_not(task, found, allowed),
                                          .allowed = allowed,
                                          .control_points = n,
                                          .deviation = deviation,
                                          .unit = unit});
    report.verdict += near_interpolation_words(n, task.samples.size(), 0, unit);
    if (!between.good)
        report.verdict += fmt::format(
            "; beside sample {} the spline strays {:.2g} times as far as allowed between samples",
            between.worst_sample, between.excess);
    return report;
}

} // namespace

Fitted surface_within(const Problem& problem) {
    const Samples& samples = problem.samples;
    const FitOptions& options = problem.options;
    const AxisPlan& plan = problem.axes;
    Stopwatch watch;
    const std::vector<double>& tolerance = problem.tolerance;
    const Index limit = options.tolerance.max_control_points;
    const double part =
        limit > 0 ? std::min(1.0, static_cast<double>(limit) / static_cast<double>(samples.size()))
                  : most_part;
    const std::vector<Index> most = most_per_axis(problem, part);
    const GridTask task{.samples = samples,
                        .parameters = problem.parameters,
                        .tolerance = tolerance,
                        .degree = plan.degree,
                        .closures = plan.closures,
                        .most = most,
                        .hold = options.hold,
                        .cancelled = options.cancelled};
    GridWithin found = searched(task);
    if (found.spline.axis_count() == 0 && limit > 0)
        throw InvalidInput(fmt::format(
            "at most {} control points: these are fewer than what must hold takes", limit));
    if (found.spline.axis_count() == 0)
        throw SolverError(
            "no number of control points gives a solvable system: the grid's parameters coincide");
    std::vector<double> away = parametric_deviations(found.spline, samples, problem.parameters);
    Fitted result{found.spline, problem.parameters,
                  judged(task, found, limit, *std::ranges::max_element(away), options.unit),
                  DeviationKind::parametric, std::move(away)};
    result.report.seconds.emplace_back("search", watch.lap());
    return result;
}

} // namespace batten
