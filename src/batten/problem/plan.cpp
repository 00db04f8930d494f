#include <batten/problem/plan.hpp>

#include <batten/core/counts.hpp>
#include <batten/spline/spline.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

template <class T>
std::vector<T> per_axis(const std::vector<T>& given, Index axes, std::string_view what) {
    if (given.size() == 1) return std::vector<T>(static_cast<std::size_t>(axes), given[0]);
    if (static_cast<Index>(given.size()) != axes)
        throw InvalidInput(fmt::format("{}: {} values given for {} {}", what, given.size(), axes,
                                       axes == 1 ? "axis" : "axes"));
    return given;
}

/// Runs `work` and puts the axis before what it throws.
template <class Work>
auto on_axis(std::size_t axis, Work work) {
    try {
        return work();
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("axis {}: {}", axis, error.what()));
    }
}

KnotVector given_knots(const std::vector<double>& knots, int degree, Closure closure,
                       const std::vector<double>& t) {
    KnotVector result(degree, knots, closure);
    if (closure == Closure::open && !t.empty() &&
        (t.front() < result.begin() || t.back() > result.end()))
        throw InvalidInput(fmt::format("parameters [{}, {}] are outside the knots' domain [{}, {}]",
                                       t.front(), t.back(), result.begin(), result.end()));
    return result;
}

/// Throws InvalidInput when memory cannot hold the control points, or of a cloud the normal system:
/// half of the numbers for the control points within degree on each side, for each.
void check_net(const Samples& samples, const AxisPlan& plan) {
    constexpr std::string_view what = "control points";
    Index system = 1;
    if (samples.grid.empty())
        for (int degree : plan.degree) system *= system == 1 ? degree + 1 : 2 * degree + 1;
    const std::array numbers{checked_product(plan.control_points, what),
                             std::max(samples.dim(), system)};
    check_memory(checked_product(numbers, what), what);
}

} // namespace

std::vector<int> degrees_per_axis(const ShapeOptions& options, Index axes) {
    return per_axis(options.degree, axes, "degree");
}

AxisPlan plan_axes(const Samples& samples, const ShapeOptions& options) {
    const Index axes = options.parameters ? options.parameters->axis_count() : samples.axis_count();
    AxisPlan plan;
    plan.degree = degrees_per_axis(options, axes);
    plan.closures = per_axis(options.closures, axes, "closed");
    if (!options.knots.empty()) {
        if (static_cast<Index>(options.knots.size()) != axes)
            throw InvalidInput(
                fmt::format("knots: {} vectors given for {} axes", options.knots.size(), axes));
        return plan;
    }
    if (options.control_points.empty())
        throw InvalidInput("the number of control points is not stated");
    plan.control_points = per_axis(options.control_points, axes, "control points");
    for (std::size_t k = 0; k < plan.degree.size(); ++k) {
        if (plan.degree[k] < 1 || plan.degree[k] > max_degree)
            throw InvalidInput(fmt::format("axis {}: degree {} is outside 1 to {}", k,
                                           plan.degree[k], max_degree));
        if (plan.control_points[k] < plan.degree[k] + 1)
            throw InvalidInput(
                fmt::format("axis {}: degree {} needs at least {} control points, got {}", k,
                            plan.degree[k], plan.degree[k] + 1, plan.control_points[k]));
        if (options.parameters && options.parameters->is_scattered()) continue;
        if (plan.control_points[k] > samples.shape()[k])
            throw InvalidInput(
                fmt::format("axis {}: {} control points need at least as many samples, got {}", k,
                            plan.control_points[k], samples.shape()[k]));
    }
    check_net(samples, plan);
    return plan;
}

Parameters choose_parameters(const Samples& samples, const ShapeOptions& options,
                             const AxisPlan& plan) {
    if (!options.parameters) return parametrize(samples, options.parametrization, plan.closures);
    check(*options.parameters, samples);
    return *options.parameters;
}

std::vector<KnotVector> choose_knots(const Parameters& parameters, const ShapeOptions& options,
                                     const AxisPlan& plan) {
    std::vector<KnotVector> result;
    for (std::size_t k = 0; k < plan.degree.size(); ++k) {
        std::vector<double> t;
        if (parameters.is_scattered()) {
            for (Index i = 0; i < parameters.scattered.size(); ++i)
                t.push_back(parameters.scattered(i, static_cast<Index>(k)));
            std::ranges::sort(t);
        } else {
            t = parameters.axes[k];
        }
        result.push_back(on_axis(k, [&] {
            const Closure closure = plan.closures[k];
            if (!options.knots.empty())
                return given_knots(options.knots[k], plan.degree[k], closure, t);
            const Index n = plan.control_points[k];
            if (options.placement == KnotPlacement::data && !parameters.is_scattered())
                return knots_from_parameters(t, plan.degree[k], n, closure);
            const bool closed = closure == Closure::closed;
            return uniform_knots(plan.degree[k], n, closed ? 0 : t.front(), closed ? 1 : t.back(),
                                 closure);
        }));
    }
    return result;
}

std::vector<Index> smoothing_size(const Samples& samples, const ShapeOptions& shape) {
    const bool cloud = shape.parameters && shape.parameters->is_scattered();
    const Index axes = cloud ? shape.parameters->axis_count() : samples.axis_count();
    const std::vector<int> degree = degrees_per_axis(shape, axes);
    std::vector<Index> result;
    for (std::size_t k = 0; k < degree.size(); ++k) {
        const double along =
            cloud ? std::pow(static_cast<double>(samples.size()), 1 / static_cast<double>(axes))
                  : static_cast<double>(samples.shape()[k]);
        const Index most = axes == 1 ? 200 : axes == 2 ? 60 : 20;
        result.push_back(std::clamp(static_cast<Index>(along / 2), Index{2 * degree[k] + 1}, most));
    }
    return result;
}

} // namespace batten
