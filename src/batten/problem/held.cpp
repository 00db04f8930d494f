#include <batten/problem/held.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/grid_index.hpp>
#include <batten/core/vectors.hpp>
#include <batten/measure/deviation.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

std::string name_of(const HeldBoundary& boundary) {
    return fmt::format("boundary {}{}", "uvw"[boundary.axis],
                       boundary.end == AxisEnd::begin ? 0 : 1);
}

void check_tangent(const HeldTangent& tangent, const Samples& samples, SampleKind kind,
                   Index axes) {
    const Index m = samples.size();
    const Index i = tangent.sample;
    check_sample("tangent at sample", i, m);
    if (static_cast<Index>(tangent.value.size()) != samples.dim())
        throw InvalidInput(fmt::format("tangent at sample {}: {} coordinates given in dimension {}",
                                       i, tangent.value.size(), samples.dim()));
    if (tangent.axis < 0 || tangent.axis >= axes)
        throw InvalidInput(
            fmt::format("tangent at sample {}: axis {} does not exist", i, tangent.axis));
    const double length = norm(tangent.value);
    if (!std::isfinite(length) || (tangent.kind == TangentKind::direction && !(length > 0)))
        throw InvalidInput(
            fmt::format("tangent at sample {}: a finite vector of some length is needed", i));
    if (kind != SampleKind::cloud && tangent.kind == TangentKind::direction) {
        const GridIndex grid(samples.shape());
        const auto axis = static_cast<std::size_t>(tangent.axis);
        const Index step = grid.stride(axis);
        const Index at = grid.place(i)[axis];
        const auto before = samples.points[at > 0 ? i - step : i];
        const auto after = samples.points[at + 1 < grid.length(axis) ? i + step : i];
        std::vector<double> chord(before.size());
        for (std::size_t d = 0; d < chord.size(); ++d) chord[d] = after[d] - before[d];
        if (dot(chord, tangent.value) < 0)
            throw InvalidInput(fmt::format("tangent at sample {}: it points against the order of "
                                           "the samples; reverse its sign",
                                           i));
    }
}

void check_boundary(const HeldBoundary& boundary, const Samples& samples, SampleKind kind,
                    const AxisPlan& plan) {
    const std::vector<int>& degree = plan.degree;
    const auto axes = static_cast<Index>(plan.count());
    if (boundary.axis >= 0 && boundary.axis < 3 && kind != SampleKind::grid)
        throw InvalidInput(name_of(boundary) +
                           ": only a grid's surface or volume has boundaries to hold");
    if (boundary.axis < 0 || boundary.axis >= axes)
        throw InvalidInput(
            fmt::format("boundary of axis {}: the fit has {} axes", boundary.axis, axes));
    const std::string name = name_of(boundary);
    if (boundary.spline.axis_count() != axes - 1)
        throw InvalidInput(fmt::format("{}: a spline of {} {} is needed, got {}", name, axes - 1,
                                       axes == 2 ? "axis" : "axes", boundary.spline.axis_count()));
    if (boundary.spline.dim() != samples.dim())
        throw InvalidInput(fmt::format("{}: it is of dimension {}, the samples of {}", name,
                                       boundary.spline.dim(), samples.dim()));
    for (std::size_t k = 0, other = 0; k < degree.size(); ++k) {
        if (plan.closures[k] == Closure::closed)
            throw InvalidInput(fmt::format("{}: axis {} is closed", name, k));
        if (static_cast<int>(k) == boundary.axis) continue;
        const KnotVector& knots = boundary.spline.axis(static_cast<Index>(other++));
        if (knots.degree() != degree[k])
            throw InvalidInput(fmt::format("{}: it is of degree {}, the fit of degree {}", name,
                                           knots.degree(), degree[k]));
        if (knots.closed()) throw InvalidInput(name + ": it is closed");
    }
}

/// The boundary's knots on `axis` of the fit, stretched to the domain [begin, end].
KnotVector stretched(const KnotVector& knots, double begin, double end) {
    std::vector<double> t(knots.knots().begin(), knots.knots().end());
    for (double& x : t) {
        if (x <= knots.begin())
            x = begin;
        else if (x >= knots.end())
            x = end;
        else
            x = begin + (end - begin) * ((x - knots.begin()) / knots.length());
    }
    return {knots.degree(), std::move(t)};
}

/// Position of the fit's axis among the boundary's.
Index boundary_axis(const HeldBoundary& boundary, int axis) {
    return axis < boundary.axis ? axis : axis - 1;
}

void hold_boundary(const HeldBoundary& boundary, const std::vector<KnotVector>& axes,
                   Constraints& constraints) {
    std::vector<KnotVector> same;
    for (int k = 0; k < static_cast<int>(axes.size()); ++k) {
        const KnotVector& knots = axes[static_cast<std::size_t>(k)];
        if (k != boundary.axis)
            same.push_back(stretched(boundary.spline.axis(boundary_axis(boundary, k)),
                                     knots.begin(), knots.end()));
    }
    Spline spline(same, boundary.spline.control_points());
    for (int k = 0; k < static_cast<int>(axes.size()); ++k)
        if (k != boundary.axis)
            spline = refine(spline, boundary_axis(boundary, k), axes[static_cast<std::size_t>(k)]);
    const GridIndex net(free_shape(axes));
    const auto axis = static_cast<std::size_t>(boundary.axis);
    const Index at = boundary.end == AxisEnd::begin ? 0 : net.length(axis) - 1;
    Index next = 0;
    net.for_each_strand(axis, [&](const GridIndex::Strand& strand) {
        constraints.fix(strand[at], spline.control_points()[next++], name_of(boundary));
    });
}

} // namespace

void check_held(const HoldOptions& hold, const Samples& samples, SampleKind kind,
                const AxisPlan& plan) {
    check_interpolated(hold.interpolate, samples.size());
    for (const HeldTangent& tangent : hold.tangents)
        check_tangent(tangent, samples, kind, static_cast<Index>(plan.count()));
    for (const HeldBoundary& boundary : hold.boundaries)
        check_boundary(boundary, samples, kind, plan);
}

Constraints held_constraints(const std::vector<KnotVector>& axes, const Samples& samples,
                             const Parameters& parameters, const HoldOptions& hold) {
    Constraints result = interpolate_samples(axes, samples, parameters, hold.interpolate);
    for (const HeldTangent& tangent : hold.tangents) {
        std::vector<int> orders(axes.size(), 0);
        orders[static_cast<std::size_t>(tangent.axis)] = 1;
        const std::vector<double> t = parameter_of(parameters, tangent.sample);
        const std::string name = fmt::format("tangent at sample {}", tangent.sample);
        if (tangent.kind == TangentKind::direction)
            result.add_direction(axes, t, orders, tangent.value, name);
        else
            result.add(axes, t, orders, tangent.value, name);
    }
    for (const HeldBoundary& boundary : hold.boundaries) hold_boundary(boundary, axes, result);
    return result;
}

namespace {

/// Along the axis that a grid's boundary has, ascending parts of it: those of the closest points of
/// the samples beside it, from 0 to 1.
std::vector<double> parts_along(const HeldBoundary& boundary, const Samples& samples) {
    const GridIndex grid(samples.grid);
    const auto across = static_cast<std::size_t>(boundary.axis);
    const Index m = grid.length(1 - across);
    PointSet row(m, samples.dim());
    for (Index j = 0; j < m; ++j) {
        GridIndex::Place place{};
        place[across] = boundary.end == AxisEnd::begin ? 0 : grid.length(across) - 1;
        place[1 - across] = j;
        std::ranges::copy(samples.points[grid.at(place)], row[j].begin());
    }
    const KnotVector& knots = boundary.spline.axis(0);
    std::vector<double> parts;
    double last = 0;
    for (const ClosestPoint& closest : closest_points(boundary.spline, row)) {
        last = std::max(last, (closest.parameter[0] - knots.begin()) / knots.length());
        parts.push_back(last);
    }
    parts.front() = 0;
    parts.back() = 1;
    return parts;
}

} // namespace

Parameters parameters_for_boundaries(const Samples& samples, Parameters parameters,
                                     const std::vector<HeldBoundary>& boundaries) {
    if (samples.grid.size() != 2) return parameters;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        std::vector<double> sum(static_cast<std::size_t>(samples.grid[axis]), 0);
        double count = 0;
        for (const HeldBoundary& boundary : boundaries) {
            if (static_cast<std::size_t>(boundary.axis) == axis) continue;
            const std::vector<double> parts = parts_along(boundary, samples);
            for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += parts[j];
            ++count;
        }
        if (count == 0) continue;
        for (double& t : sum) t /= count;
        parameters.axes[axis] = std::move(sum);
    }
    return parameters;
}

KnotVector knots_for_boundaries(const KnotVector& knots, int axis,
                                const std::vector<HeldBoundary>& boundaries) {
    std::vector<double> needed; // interior, with multiplicity
    for (const HeldBoundary& boundary : boundaries) {
        if (boundary.axis == axis) continue;
        const KnotVector own = stretched(boundary.spline.axis(boundary_axis(boundary, axis)),
                                         knots.begin(), knots.end());
        std::vector<double> interior;
        for (double t : own.knots())
            if (t > own.begin() && t < own.end()) interior.push_back(t);
        std::vector<double> merged;
        std::ranges::set_union(needed, interior, std::back_inserter(merged));
        needed = std::move(merged);
    }
    if (needed.empty()) return knots;
    std::vector<double> others;
    for (double t : knots.knots())
        if (t > knots.begin() && t < knots.end()) others.push_back(t);
    for (double t : needed) { // the nearest of the others gives way
        if (others.empty()) break;
        const auto nearest =
            std::ranges::min_element(others, {}, [&](double other) { return std::abs(other - t); });
        others.erase(nearest);
    }
    others.insert(others.end(), needed.begin(), needed.end());
    std::ranges::sort(others);
    return knots_around(knots.degree(), others, knots.begin(), knots.end());
}

double boundary_error(const Spline& spline, const std::vector<HeldBoundary>& boundaries) {
    double worst = 0;
    for (const HeldBoundary& boundary : boundaries) {
        std::vector<std::vector<double>> whole; // places on the surface, and on the boundary
        std::vector<std::vector<double>> own;
        for (int k = 0; k < static_cast<int>(spline.axis_count()); ++k) {
            const KnotVector& knots = spline.axis(k);
            if (k == boundary.axis) {
                whole.push_back({boundary.end == AxisEnd::begin ? knots.begin() : knots.end()});
                continue;
            }
            whole.push_back(greville_abscissae(knots));
            const KnotVector& other = boundary.spline.axis(boundary_axis(boundary, k));
            own.push_back(whole.back());
            for (double& t : own.back())
                t = other.begin() + other.length() * ((t - knots.begin()) / knots.length());
        }
        PointSet gap = evaluate_grid(spline, whole);
        add_scaled(gap, -1.0, evaluate_grid(boundary.spline, own));
        worst = std::max(worst, largest_length(gap));
    }
    return worst;
}

double tangent_error(const Spline& spline, const Samples& samples, const Parameters& parameters,
                     const std::vector<HeldTangent>& tangents) {
    const double size = diagonal(samples.points);
    double worst = 0;
    for (const HeldTangent& tangent : tangents) {
        std::vector<int> orders(static_cast<std::size_t>(spline.axis_count()), 0);
        orders[static_cast<std::size_t>(tangent.axis)] = 1;
        std::vector<double> got = spline(parameter_of(parameters, tangent.sample), orders);
        const double wanted = norm(tangent.value);
        const double factor = tangent.kind == TangentKind::derivative
                                  ? 1
                                  : dot(got, tangent.value) / (wanted * wanted);
        for (std::size_t d = 0; d < got.size(); ++d) got[d] -= factor * tangent.value[d];
        const double error =
            factor > 0 && size > 0 ? norm(got) / size : std::numeric_limits<double>::infinity();
        worst = std::max(worst, error);
    }
    return worst;
}

} // namespace batten
