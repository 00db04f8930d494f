#include <batten/fair/fair.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/fair/fairing_system.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/nested_cholesky.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr int highest_order = 3;

void check_weight(double w) {
    if (!(w >= 0 && w < 1))
        throw InvalidInput(fmt::format("fair: weight {} is outside 0 <= weight < 1", w));
}

/// The weight of every free control point.
std::vector<double> weights_of(const FairOptions& options, Index count) {
    if (options.weights.empty()) {
        check_weight(options.weight);
        return std::vector<double>(static_cast<std::size_t>(count), options.weight);
    }
    if (static_cast<Index>(options.weights.size()) != count)
        throw InvalidInput(fmt::format("fair: {} weights for {} free control points",
                                       options.weights.size(), count));
    std::ranges::for_each(options.weights, check_weight);
    return options.weights;
}

/// All but the ends of open axes.
std::vector<Index> inner_points(const std::vector<KnotVector>& axes, const GridIndex& net) {
    std::vector<Index> result;
    net.for_each([&](const GridIndex::Place& place, Index i) {
        for (std::size_t k = 0; k < axes.size(); ++k)
            if (!axes[k].closed() && (place[k] == 0 || place[k] + 1 == net.length(k))) return;
        result.push_back(i);
    });
    return result;
}

std::vector<Index> stated_points(const FairOptions& options, Index count) {
    std::vector<Index> points = options.points;
    std::ranges::sort(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (points[k] < 0 || points[k] >= count)
            throw InvalidInput(fmt::format("fair: control point {}: there are {}, counted from 0",
                                           points[k], count));
        if (k > 0 && points[k] == points[k - 1])
            throw InvalidInput(fmt::format("fair: control point {} is named twice", points[k]));
    }
    return points;
}

std::vector<Index> moving_points(const FairingSystem& system, const FairOptions& options) {
    if (options.automatic < 0)
        throw InvalidInput(fmt::format("fair: automatic {}: a count is needed", options.automatic));
    if (!options.points.empty() && options.automatic > 0)
        throw InvalidInput("fair: points are stated and chosen; one of both");
    if (!options.points.empty()) return stated_points(options, system.size());
    std::vector<Index> inner = inner_points(system.axes(), system.controls());
    if (options.automatic == 0) return inner;
    const std::vector<double> gains = system.gains();
    std::ranges::stable_sort(inner, std::ranges::greater{},
                             [&](Index i) { return gains[static_cast<std::size_t>(i)]; });
    inner.resize(std::min(inner.size(), static_cast<std::size_t>(options.automatic)));
    std::ranges::sort(inner);
    return inner;
}

std::string method_of(const FairOptions& options, const FairingSystem& system) {
    if (method_entry(options.method).needs_samples)
        throw InvalidInput(fmt::format(
            "fair: method {} is for samples; direct, lin2018, cg, ... can", options.method));
    if (options.method != "auto") return options.method;
    return system.size() <= most_dissected(system.axes().size()) ? "direct" : "cg";
}

PointSet solved(const FairingSystem& system) {
    try {
        return factorize(system)->solve(system.rhs());
    } catch (const SolverError&) {
        throw InvalidInput(
            "fair: weights so near 1 hold nothing where it is; take smaller ones, or "
            "let fewer control points move");
    }
}

} // namespace

FairResult fair(const Spline& spline, const FairOptions& options) {
    if (options.order < 1 || options.order > highest_order)
        throw InvalidInput(fmt::format("fair: order {}: 1 to {}", options.order, highest_order));
    for (Index k = 0; k < spline.axis_count(); ++k)
        if (spline.axis(k).degree() < options.order)
            throw InvalidInput(fmt::format("fair: order {} is above the degree {} of axis {}",
                                           options.order, spline.axis(k).degree(), k));
    FairingSystem system(spline, options.order);
    std::vector<double> weights = weights_of(options, system.size());
    FairReport report{.energy_before = system.energy(), .moving = moving_points(system, options)};
    std::vector<double> moving(weights.size(), 0);
    for (Index i : report.moving)
        moving[static_cast<std::size_t>(i)] = weights[static_cast<std::size_t>(i)];
    system.weigh(moving);
    report.method = method_of(options, system);
    PointSet moves(system.size(), system.dim());
    if (report.method == "direct") {
        check_settings(method_entry("direct"), options.settings);
        moves = solved(system);
    } else {
        const auto method = make_method(report.method, system, options.settings);
        report.course = iterate(*method, moves, options.stop);
        report.settings = method->account();
    }
    report.energy_after = system.energy(moves);
    report.largest_move = largest_length(moves);
    PointSet control = spline.free_control_points();
    add_scaled(control, 1.0, moves);
    return {Spline::from_free(spline.axes(), control), std::move(report)};
}

} // namespace batten
