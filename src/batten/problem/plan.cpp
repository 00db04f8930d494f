#include <batten/problem/plan.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/problem/held.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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

/// Where an axis's parameters begin and end.
struct Extent {
    double begin;
    double end;
};

Extent extent_of(const Parameters& parameters, std::size_t axis) {
    if (!parameters.is_scattered())
        return {parameters.axes[axis].front(), parameters.axes[axis].back()};
    const PointSet box = bounding_box(parameters.scattered);
    return {box(0, static_cast<Index>(axis)), box(1, static_cast<Index>(axis))};
}

KnotVector given_knots(const std::vector<double>& knots, int degree, Closure closure,
                       const Extent& extent) {
    KnotVector result(degree, knots, closure);
    if (closure == Closure::open && (extent.begin < result.begin() || extent.end > result.end()))
        throw InvalidInput(fmt::format("parameters [{}, {}] are outside the knots' domain [{}, {}]",
                                       extent.begin, extent.end, result.begin(), result.end()));
    return result;
}

/// The rule for knots where the options leave it open: that of the papers for their methods.
KnotPlacement placement_of(const FitOptions& options) {
    if (options.shape.placement) return *options.shape.placement;
    return options.method.name == "auto" ? KnotPlacement::both_ends : KnotPlacement::data;
}

/// The parameters that differ, by more than a small part of their range.
std::vector<double> apart(const std::vector<double>& parameters) {
    const double apart = 1e-9 * (parameters.back() - parameters.front());
    std::vector<double> result;
    for (double t : parameters)
        if (result.empty() || t - result.back() > apart) result.push_back(t);
    return result;
}

/// Closed knots whose seam has the multiplicity that its continuity takes.
KnotVector with_seam(const KnotVector& knots, int copies) {
    if (copies == 0) return knots;
    std::vector<double> interior(static_cast<std::size_t>(copies), knots.begin());
    const std::vector<double> breaks = knots.breakpoints();
    interior.insert(interior.end(), breaks.begin() + 1, breaks.end() - 1);
    return knots_around(knots.degree(), interior, knots.begin(), knots.end(), Closure::closed);
}

/// The parameters among which knots are placed: each once where what is wanted is smooth, or where
/// as many samples share one as are in a span, for knots would meet there.
std::vector<double> knot_places(const Problem& problem, std::size_t axis, Index n) {
    const std::vector<double>& t = problem.parameters.axes[axis];
    const auto m = static_cast<Index>(t.size());
    if (problem.options.smooth.wanted) return apart(t);
    const Index spans = n - problem.axes.degree[axis];
    Index run = 1;
    Index longest = 1;
    for (Index i = 1; i < m; ++i) {
        run = t[static_cast<std::size_t>(i)] == t[static_cast<std::size_t>(i - 1)] ? run + 1 : 1;
        longest = std::max(longest, run);
    }
    const bool meet = n < m && (longest - 1) * spans >= m;
    return meet ? apart(t) : t;
}

KnotVector axis_knots(const Problem& problem, std::size_t axis) {
    const ShapeOptions& shape = problem.options.shape;
    const AxisPlan& plan = problem.axes;
    const Extent extent = extent_of(problem.parameters, axis);
    const int degree = plan.degree[axis];
    const Closure closure = plan.closures[axis];
    if (!shape.knots.empty()) return given_knots(shape.knots[axis], degree, closure, extent);
    const bool closed = closure == Closure::closed;
    const int copies =
        closed && shape.seam_continuity >= 0 ? degree - 1 - shape.seam_continuity : 0;
    const Index n = plan.control_points[axis] - copies;
    if (n < degree + 1)
        throw InvalidInput(
            fmt::format("degree {} with continuity C{} at the seam needs at least {} "
                        "control points, got {}",
                        degree, shape.seam_continuity, degree + 1 + copies, n + copies));
    const KnotPlacement rule = placement_of(problem.options);
    const bool even = rule == KnotPlacement::uniform || problem.kind == SampleKind::cloud;
    const std::vector<double> places = even ? std::vector<double>() : knot_places(problem, axis, n);
    const bool fewer = static_cast<Index>(places.size()) < n;
    const KnotVector knots =
        even || fewer
            ? uniform_knots(degree, n, closed ? 0 : extent.begin, closed ? 1 : extent.end, closure)
            : knots_from_parameters(places, degree, n, closure, rule);
    return with_seam(knots, copies);
}

} // namespace

AxisPlan plan_axes(const ShapeOptions& options, Index axes) {
    AxisPlan plan;
    plan.degree = per_axis(options.degree, axes, "degree");
    plan.closures = per_axis(options.closures, axes, "closed");
    for (std::size_t k = 0; k < plan.degree.size(); ++k)
        if (plan.degree[k] < 1 || plan.degree[k] > max_degree)
            throw InvalidInput(fmt::format("axis {}: degree {} is outside 1 to {}", k,
                                           plan.degree[k], max_degree));
    if (!options.knots.empty() && static_cast<Index>(options.knots.size()) != axes)
        throw InvalidInput(
            fmt::format("knots: {} vectors given for {} axes", options.knots.size(), axes));
    if (options.control_points.empty()) return plan;
    if (!options.knots.empty())
        throw InvalidInput(
            "control points and knots: the knots state the number of control points");
    plan.control_points = per_axis(options.control_points, axes, "control points");
    for (std::size_t k = 0; k < plan.count(); ++k)
        if (plan.control_points[k] < plan.degree[k] + 1)
            throw InvalidInput(
                fmt::format("axis {}: degree {} needs at least {} control points, got {}", k,
                            plan.degree[k], plan.degree[k] + 1, plan.control_points[k]));
    return plan;
}

std::vector<KnotVector> fixed_knots(const Problem& problem) {
    if (!problem.sized()) throw InvalidInput("the number of control points is not stated");
    std::vector<KnotVector> result;
    for (std::size_t k = 0; k < problem.axes.count(); ++k)
        result.push_back(knots_for_boundaries(on_axis(k, [&] { return axis_knots(problem, k); }),
                                              static_cast<int>(k),
                                              problem.options.hold.boundaries));
    return result;
}

std::vector<Index> smoothing_size(const Problem& problem) {
    const std::size_t axes = problem.axes.count();
    std::vector<Index> result;
    for (std::size_t k = 0; k < axes; ++k) {
        const bool cloud = problem.parameters.is_scattered();
        const Index places = cloud ? static_cast<Index>(samples_along(problem, k))
                                   : static_cast<Index>(apart(problem.parameters.axes[k]).size());
        const Index few = std::min<Index>(places, 2 * problem.axes.degree[k] + 1);
        const Index wanted = std::min(std::max(places / 2, few), most_smoothing_size(problem));
        result.push_back(std::max<Index>(wanted, problem.axes.degree[k] + 1));
    }
    return result;
}

Index most_smoothing_size(const Problem& problem) {
    const std::size_t axes = problem.axes.count();
    if (problem.parameters.is_scattered()) return axes == 2 ? 60 : 20;
    return axes == 1 ? 2000 : axes == 2 ? 100 : 25;
}

double samples_along(const Problem& problem, std::size_t axis) {
    if (problem.kind == SampleKind::grid) return static_cast<double>(problem.samples.grid[axis]);
    return std::pow(static_cast<double>(problem.samples.size()),
                    1 / static_cast<double>(problem.axes.count()));
}

} // namespace batten
