#include <batten/fit/solve_system.hpp>

#include <batten/basis/nested_knots.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/problem/plan.hpp>
#include <batten/problem/problem.hpp>
#include <batten/solve/condition.hpp>
#include <batten/solve/factor_search.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace batten {

namespace {

KnotVector nested_in(const KnotVector& knots, Index count, std::size_t axis) {
    std::vector<Index> sizes;
    for (const KnotVector& some : nested_knots(knots)) {
        if (some.free_count() == count) return some;
        sizes.push_back(some.free_count());
    }
    throw InvalidInput(fmt::format("axis {}: {} control points: their knots are not nested in the "
                                   "saved system's; possible are {}",
                                   axis, count, fmt::join(sizes, ", ")));
}

/// The knots that are asked for.
std::vector<KnotVector> wanted_axes(const SystemSums& sums, const SolveOptions& options) {
    std::vector<KnotVector> axes = sums.axes;
    if (!options.knots.empty() && !options.control_points.empty())
        throw InvalidInput(
            "control points and knots: the knots state the number of control points");
    if (!options.knots.empty() && options.knots.size() != axes.size())
        throw InvalidInput(
            fmt::format("knots: {} vectors given for {} axes", options.knots.size(), axes.size()));
    const std::vector<Index>& n = options.control_points;
    if (n.size() > 1 && n.size() != axes.size())
        throw InvalidInput(
            fmt::format("control points: {} values given for {} axes", n.size(), axes.size()));
    for (std::size_t k = 0; k < axes.size(); ++k) {
        if (!options.knots.empty())
            axes[k] = KnotVector(axes[k].degree(), options.knots[k], axes[k].closure());
        if (!n.empty()) axes[k] = nested_in(axes[k], n[n.size() == 1 ? 0 : k], k);
    }
    return axes;
}

void check_smooth(const NormalSystem& system, const SmoothOptions& smooth) {
    if (!smooth.wanted) return;
    AxisPlan plan;
    for (const KnotVector& axis : system.axes()) plan.degree.push_back(axis.degree());
    check_smoothing(smooth, plan);
    if (smooth.lambda == 0)
        throw InvalidInput("smoothing: cross-validation needs the samples; state a factor");
    const double most = largest_factor(system, smooth.order, Solution::entries);
    if (smooth.lambda > most)
        throw InvalidInput(fmt::format("smoothing by {}: the largest factor that a saved system "
                                       "can tell from an infinite one here is {:.2g}",
                                       smooth.lambda, most));
}

std::unique_ptr<Factorization> factors_of(const NormalSystem& system) {
    try {
        return factorize(system);
    } catch (const SolverError& error) {
        throw SolverError(
            fmt::format("{}; fewer control points or smoothing may do", error.what()));
    }
}

SolveReport report_of(const SystemSums& sums, const std::vector<KnotVector>& assembled) {
    SolveReport report{.samples = sums.samples,
                       .dim = sums.rhs.dim(),
                       .control_shape = free_shape(sums.axes),
                       .assembled_shape = free_shape(assembled),
                       .weighted = sums.weight != static_cast<double>(sums.samples),
                       .data_size = distance(sums.box[0], sums.box[1])};
    for (const KnotVector& axis : sums.axes) {
        report.degree.push_back(axis.degree());
        report.closures.push_back(axis.closure());
    }
    return report;
}

} // namespace

SolveResult solve_system(SystemSums sums, const SolveOptions& options) {
    Stopwatch watch;
    const std::vector<KnotVector> assembled = sums.axes;
    sums = coarsened(std::move(sums), wanted_axes(sums, options));
    SolveReport report = report_of(sums, assembled);
    const double weight = sums.weight;
    const auto system = system_of(std::move(sums));
    check_smooth(*system, options.smooth);
    auto smoothed = system->clone();
    if (options.smooth.wanted) smoothed->add_roughness(options.smooth.lambda, options.smooth.order);
    report.smoothing = options.smooth.lambda;
    const auto factors = factors_of(*smoothed);
    const PointSet control = factors->solve(smoothed->rhs());
    const ResidualEnergy energy = residual_energy(*system, control);
    report.rms = std::sqrt(energy.value / weight);
    report.rms_rounding = std::sqrt(energy.rounding / weight);
    report.digits =
        -std::log10(std::numeric_limits<double>::epsilon() * inverse_norm(*smoothed, *factors));
    Spline spline = Spline::from_free(system->axes(), uncentred(control, system->centre()));
    report.kind = kind_name(spline);
    report.seconds = watch.lap();
    return {std::move(spline), std::move(report)};
}

} // namespace batten
