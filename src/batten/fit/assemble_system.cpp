#include <batten/fit/assemble_system.hpp>

#include <batten/problem/plan.hpp>
#include <batten/samples/scan.hpp>
#include <batten/system/normal_system.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// Sums of systems add up as they are: nothing can be rescaled in one of them alone.
void check_range(const Samples& samples) {
    constexpr double most = 0x1p200;
    if (usual_unit(bounding_box(samples.points)) != 1)
        throw InvalidInput("the points' coordinates are outside 1e-60 to 1e60, so that sums of "
                           "their squares leave the range of numbers; take another unit");
    if (samples.weights.empty()) return;
    const auto [least, largest] = std::ranges::minmax(samples.weights);
    if (least < 1 / most || largest > most)
        throw InvalidInput(fmt::format("weights from {:.3g} to {:.3g}: a saved system holds those "
                                       "from 1e-60 to 1e60",
                                       least, largest));
}

/// Evenly spaced knots over the stated domain in place of the stated sizes.
void place_over_domain(const Samples& samples, const AssembleOptions& options,
                       ShapeOptions& shape) {
    const Index axes = axis_count(samples, shape);
    const AxisPlan plan = plan_axes(shape, axes);
    if (plan.control_points.empty())
        throw InvalidInput("domain: the number of control points over it is not stated");
    if (shape.placement || shape.seam_continuity >= 0)
        throw InvalidInput("domain: its knots are evenly spaced, the seam as smooth as elsewhere; "
                           "state knots where they are to be others");
    if (options.domain.size() != 1 && options.domain.size() != plan.count())
        throw InvalidInput(
            fmt::format("domain: {} given for {} axes", options.domain.size(), axes));
    for (std::size_t k = 0; k < plan.count(); ++k) {
        const auto [begin, end] = options.domain[options.domain.size() == 1 ? 0 : k];
        if (!std::isfinite(begin) || !std::isfinite(end) || !(begin < end))
            throw InvalidInput(
                fmt::format("domain: from {} to {}: it must begin before it ends", begin, end));
        const KnotVector knots =
            uniform_knots(plan.degree[k], plan.control_points[k], begin, end, plan.closures[k]);
        shape.knots.emplace_back(knots.knots().begin(), knots.knots().end());
    }
    shape.control_points.clear();
}

/// A cloud's coordinates in its plane as they stand, so that they mean the same in every file.
void take_coordinates(const Samples& samples, ShapeOptions& shape) {
    const bool cloud = shape.projection || samples.kind() == SampleKind::cloud;
    if (!cloud || shape.parameters || !samples.grid.empty()) return;
    const Projection plane = shape.projection                 ? *shape.projection
                             : samples.order == Order::ground ? Projection::xy
                                                              : Projection::plane;
    if (plane == Projection::plane)
        throw InvalidInput("project: every cloud has a best plane of its own; state one of "
                           "coordinates (xy, xz, yz) where the knots are stated");
    shape.parameters = Parameters{{}, plane_coordinates(samples, plane)};
    shape.projection.reset();
}

} // namespace

SystemSums assemble_system(const Samples& samples, const AssembleOptions& options) {
    check(samples);
    check_range(samples);
    FitOptions all;
    all.shape = options.shape;
    ShapeOptions& shape = all.shape;
    if (shape.control_points.empty() && shape.knots.empty())
        throw InvalidInput("neither the number of control points nor knots are stated");
    if (!options.domain.empty()) place_over_domain(samples, options, shape);
    if (!shape.knots.empty()) take_coordinates(samples, shape);
    Problem problem = problem_of(samples, all);
    std::vector<double>& weights = problem.samples.weights;
    if (std::ranges::all_of(weights, [](double w) { return w == 1; })) weights.clear();
    const auto system = assemble(fixed_knots(problem), problem.samples, problem.parameters);
    return sums_of(*system, problem.samples);
}

} // namespace batten
