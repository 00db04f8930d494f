#include <batten/core/stopwatch.hpp>
#include <batten/measure/between_samples.hpp>
#include <batten/problem/held.hpp>
#include <batten/search/grid_sizes.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// Greatest number of control points along each axis, so that together they are at most `part` of
/// the samples.
std::vector<Index> most_per_axis(const Samples& samples, const Parameters& parameters,
                                 const AxisPlan& plan, double part) {
    const auto axes = static_cast<double>(plan.degree.size());
    std::vector<Index> most;
    for (std::size_t k = 0; k < plan.degree.size(); ++k) {
        const double along = parameters.is_scattered()
                                 ? std::pow(static_cast<double>(samples.size()), 1 / axes)
                                 : static_cast<double>(samples.grid[k]);
        most.push_back(std::max<Index>(plan.degree[k] + 1,
                                       static_cast<Index>(std::pow(part, 1 / axes) * along)));
    }
    return most;
}

} // namespace

Fitted surface_within(const Problem& problem) {
    const Samples& samples = problem.samples;
    const FitOptions& options = problem.options;
    const AxisPlan& plan = problem.axes;
    Fitted result;
    FitReport& report = result.report;
    Stopwatch watch;
    result.parameters = problem.parameters;
    const std::vector<double>& tolerance = problem.tolerance;
    const Index limit = options.tolerance.max_control_points;
    const double part =
        limit > 0 ? std::min(1.0, static_cast<double>(limit) / static_cast<double>(samples.size()))
                  : most_part;
    const std::vector<Index> most = most_per_axis(samples, result.parameters, plan, part);
    const GridTask task{samples, result.parameters, tolerance,        plan.degree, plan.closures,
                        most,    options.hold,      options.cancelled};
    GridWithin found = few_knots(task);
    if (found.spline.axis_count() == 0)
        throw SolverError(
            "no number of control points gives a solvable system: the grid's parameters coincide");
    report.stages = found.stages;
    report.seconds.emplace_back("search", watch.lap());
    const double share =
        static_cast<double>(found.stages.back().second) / static_cast<double>(samples.size());
    Index worst_cell = 0;
    report.tolerance = *std::min_element(tolerance.begin(), tolerance.end());
    report.termination = found.met ? Termination::tolerance_met : Termination::tolerance_not_met;
    result.spline = std::move(found.spline);
    bool wild = false;
    if (!result.parameters.is_scattered() && found.met) {
        const BetweenSamples between =
            check_between_grid(result.spline, samples, result.parameters, tolerance);
        report.between_samples = between.excess;
        worst_cell = between.worst_sample;
        wild = between.excess > wild_part;
        if (wild) report.termination = Termination::tolerance_not_met;
    }
    report.verdict =
        wild        ? "not met: every sample is within, but the spline is wild between some"
        : found.met ? "met"
        : options.hold.equalities() && share < 0.5 * part
            ? "not met: what must hold keeps the spline from some samples; without it they might "
              "be reached"
        : limit > 0
            ? fmt::format("not met: {} control points are allowed and do not suffice", limit)
            : fmt::format(
                  "not met: more than {:.0f} % of the samples would be needed as control points",
                  100 * most_part);
    if (share > smooth_part)
        report.verdict +=
            fmt::format("{} it nearly interpolates: {:.0f} control points per 100 samples",
                        found.met ? ", but" : ";", 100 * share);
    if (report.between_samples > 1)
        report.verdict += fmt::format(
            "; beside sample {} the spline strays {:.2g} times as far as allowed between samples",
            worst_cell, report.between_samples);
    return result;
}

} // namespace batten
