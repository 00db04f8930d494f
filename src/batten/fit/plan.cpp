#include <batten/fit/plan.hpp>

#include <batten/spline/spline.hpp>

#include <algorithm>
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

/// Index of the sample that starts control point i of n on an axis of m samples.
Index start_sample(const KnotVector& knots, const std::vector<double>& t, Index i) {
    const Index n = knots.free_count();
    const auto m = static_cast<Index>(t.size());
    if (!knots.closed()) // [HuangWang2020, eq. 38], whose last line has n for m
        return i == n - 1 ? m - 1 : m * i / (n - 1);
    double greville = 0;
    for (Index k = i + 1; k <= i + knots.degree(); ++k) greville += knots[k] / knots.degree();
    const double at = knots.wrapped(greville);
    const auto after = std::ranges::lower_bound(t, at) - t.begin();
    if (after == m) return m - 1;
    return after > 0 && at - t[static_cast<std::size_t>(after - 1)] <
                            t[static_cast<std::size_t>(after)] - at
               ? after - 1
               : after;
}

} // namespace

AxisPlan plan_axes(const Samples& samples, const ShapeOptions& options) {
    const Index axes = options.parameters ? options.parameters->axis_count() : samples.axis_count();
    AxisPlan plan;
    plan.degree = per_axis(options.degree, axes, "degree");
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

PointSet initial_control(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, const MethodOptions& options) {
    const std::vector<Index> shape = free_shape(axes);
    Index total = 1;
    for (Index n : shape) total *= n;
    if (options.initial == Initial::given) {
        if (options.control.size() != total || options.control.dim() != samples.dim())
            throw InvalidInput(fmt::format(
                "initial control points: {} of dimension {} given, {} of dimension {} needed",
                options.control.size(), options.control.dim(), total, samples.dim()));
        return options.control;
    }
    PointSet control(total, samples.dim());
    if (options.initial == Initial::zero) return control;
    const std::vector<Index> grid = samples.shape();
    for (Index k = 0; k < total; ++k) {
        Index rest = k;
        Index sample = 0;
        Index stride = 1;
        for (std::size_t a = shape.size(); a-- > 0;) {
            sample += start_sample(axes[a], parameters.axes[a], rest % shape[a]) * stride;
            rest /= shape[a];
            stride *= grid[a];
        }
        std::ranges::copy(samples.points[sample], control[k].begin());
    }
    return control;
}

} // namespace batten
