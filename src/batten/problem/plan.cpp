#include <batten/problem/plan.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/counts.hpp>
#include <batten/parametrize/step_lengths.hpp>
#include <batten/problem/held.hpp>

#include <algorithm>
#include <array>
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
/// knots would meet.
std::vector<double> places_of(const Problem& problem, std::size_t axis, Index n) {
    const std::vector<double>& t = problem.parameters.axes[axis];
    const auto m = static_cast<Index>(t.size());
    if (problem.options.smooth.wanted) return apart(t);
    EqualRuns runs;
    runs.add(t);
    return knots_meet(runs.longest(), m, n, problem.axes.degree[axis]) ? apart(t) : t;
}

KnotVector axis_knots(const Problem& problem, std::size_t axis) {
    const KnotPlacement rule = placement_of(problem.options, problem.kind);
    return axis_knots(problem.options, problem.axes, axis, rule,
                      extent_of(problem.parameters, axis),
                      [&](Index n) -> std::optional<KnotVector> {
                          const std::vector<double> places = places_of(problem, axis, n);
                          if (static_cast<Index>(places.size()) < n) return std::nullopt;
                          return knots_from_parameters(places, problem.axes.degree[axis], n,
                                                       problem.axes.closures[axis], rule);
                      });
}

/// Along an axis of a sequence or grid there are no more control points than samples.
void check_counts(const AxisPlan& axes, SampleKind kind, const std::vector<Index>& shape) {
    if (kind == SampleKind::cloud) return;
    const std::vector<Index>& n = axes.control_points;
    for (std::size_t k = 0; k < n.size(); ++k)
        if (shape[k] >= 0 && n[k] > shape[k])
            throw InvalidInput(
                fmt::format("axis {}: {} control points need at least as many samples, got {}", k,
                            n[k], shape[k]));
}

/// Memory must hold the control points, and of a cloud the normal system: half of the numbers for
/// the control points within degree on each side, for each.
void check_net(const AxisPlan& axes, SampleKind kind, Index dim) {
    constexpr std::string_view what = "control points";
    Index system = 1;
    if (kind == SampleKind::cloud)
        for (int degree : axes.degree) system *= system == 1 ? degree + 1 : 2 * degree + 1;
    const std::array numbers{checked_product(axes.control_points, what), std::max(dim, system)};
    check_memory(checked_product(numbers, what), what);
}

void check_seam(const FitOptions& options, const AxisPlan& axes) {
    const int order = options.shape.seam_continuity;
    if (order < 0) return;
    if (axes.count() != 1)
        throw InvalidInput("closed: the continuity at a seam is for curves, not for axes of a "
                           "surface or volume");
    if (axes.closures[0] == Closure::open)
        throw InvalidInput(fmt::format("continuity C{} at the seam: the curve is open", order));
    if (order > axes.degree[0] - 1)
        throw InvalidInput(fmt::format("closed: continuity C{} at the seam is more than degree {} "
                                       "has anywhere, C{}",
                                       order, axes.degree[0], axes.degree[0] - 1));
}

} // namespace

void check_smoothing(const SmoothOptions& smooth, const AxisPlan& axes) {
    if (!smooth.wanted) return;
    if (smooth.order < 2 || smooth.order > 3)
        throw InvalidInput(
            fmt::format("smoothing: the derivative's order {} is not 2 or 3", smooth.order));
    if (!(smooth.lambda >= 0) || !std::isfinite(smooth.lambda))
        throw InvalidInput(
            fmt::format("smoothing: the factor {} must be positive and finite", smooth.lambda));
    for (int degree : axes.degree)
        if (degree < smooth.order)
            throw InvalidInput(fmt::format("smoothing: the derivative of order {} vanishes for "
                                           "degree {}",
                                           smooth.order, degree));
}

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

AxisPlan planned(const FitOptions& options, SampleKind kind, const std::vector<Index>& shape,
                 Index dim, Index axes) {
    AxisPlan plan = plan_axes(options.shape, axes);
    check_counts(plan, kind, shape);
    check_net(plan, kind, dim);
    check_seam(options, plan);
    check_smoothing(options.smooth, plan);
    return plan;
}

KnotPlacement placement_of(const FitOptions& options, SampleKind kind) {
    if (kind == SampleKind::cloud) return KnotPlacement::uniform;
    if (options.shape.placement) return *options.shape.placement;
    return options.method.name == "auto" ? KnotPlacement::both_ends : KnotPlacement::data;
}

bool knots_meet(Index longest_run, Index samples, Index n, int degree) {
    return n < samples && (longest_run - 1) * (n - degree) >= samples;
}

Index placed_count(const FitOptions& options, const AxisPlan& plan, std::size_t axis) {
    const int degree = plan.degree[axis];
    const int seam = options.shape.seam_continuity;
    const int copies = plan.closures[axis] == Closure::closed && seam >= 0 ? degree - 1 - seam : 0;
    const Index n = plan.control_points[axis] - copies;
    if (n < degree + 1)
        throw InvalidInput(
            fmt::format("axis {}: degree {} with continuity C{} at the seam needs at least {} "
                        "control points, got {}",
                        axis, degree, seam, degree + 1 + copies, n + copies));
    return n;
}

KnotVector axis_knots(const FitOptions& options, const AxisPlan& plan, std::size_t axis,
                      KnotPlacement rule, const Extent& extent,
                      FunctionRef<std::optional<KnotVector>(Index)> among) {
    const int degree = plan.degree[axis];
    const Closure closure = plan.closures[axis];
    if (!options.shape.knots.empty())
        return on_axis(
            axis, [&] { return given_knots(options.shape.knots[axis], degree, closure, extent); });
    const Index n = placed_count(options, plan, axis);
    const bool closed = closure == Closure::closed;
    std::optional<KnotVector> knots;
    if (rule != KnotPlacement::uniform) knots = on_axis(axis, [&] { return among(n); });
    if (!knots)
        knots =
            uniform_knots(degree, n, closed ? 0 : extent.begin, closed ? 1 : extent.end, closure);
    return with_seam(*knots, static_cast<int>(plan.control_points[axis] - n));
}

std::vector<KnotVector> fixed_knots(const Problem& problem) {
    if (!problem.sized()) throw InvalidInput("the number of control points is not stated");
    std::vector<KnotVector> result;
    for (std::size_t k = 0; k < problem.axes.count(); ++k)
        result.push_back(knots_for_boundaries(axis_knots(problem, k), static_cast<int>(k),
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
