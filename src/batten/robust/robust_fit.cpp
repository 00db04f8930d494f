#include <batten/robust/robust_fit.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/distinct.hpp>
#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/problem/plan.hpp>
#include <batten/samples/noise.hpp>
#include <batten/solve/direct.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

Spline least_squares_spline(const std::vector<KnotVector>& axes, const Samples& samples,
                            const Parameters& parameters) {
    const auto system = assemble(axes, samples, parameters);
    PointSet control(system->size(), system->dim());
    if (parameters.is_scattered()) {
        ConjugateGradients cg(*system, Preconditioner::axes);
        iterate(cg, control, {.max_iterations = 200, .relative_gradient = 1e-8});
    } else {
        control = solve_direct(*system);
    }
    return Spline::from_free(axes, uncentred(control, system->centre()));
}

/// Tukey's weight: nothing beyond `reach`.
double weight(double residual, double reach) {
    const double part = 1 - residual * residual / (reach * reach);
    return part > 0 ? part * part : 0;
}

/// Parameters of a grid's axis from the medians, over its rows, of each step's part of the row.
std::vector<double> median_chords(const Samples& samples, std::size_t axis, Closure closure) {
    const GridIndex grid(samples.grid);
    const Index m = grid.length(axis);
    const Index count = closure == Closure::closed ? m : m - 1;
    std::vector<std::vector<double>> part(static_cast<std::size_t>(count));
    grid.for_each_strand(axis, [&](const GridIndex::Strand& strand) {
        std::vector<double> chord;
        double total = 0;
        for (Index j = 0; j < count; ++j) {
            chord.push_back(
                distance(samples.points[strand[j]], samples.points[strand[(j + 1) % m]]));
            total += chord.back();
        }
        if (!(total > 0)) return;
        for (std::size_t j = 0; j < chord.size(); ++j) part[j].push_back(chord[j] / total);
    });
    std::vector<double> t{0};
    for (auto& steps : part) t.push_back(t.back() + median(std::move(steps)));
    const double length = t.back();
    if (!(length > 0))
        throw InvalidInput(fmt::format(
            "axis {}: all points are identical; a curve through them has no length", axis));
    t.resize(static_cast<std::size_t>(m));
    for (double& x : t) x /= length;
    return t;
}

} // namespace

Parameters robust_parameters(const Problem& problem) {
    const Samples& samples = problem.samples;
    const ShapeOptions& shape = problem.options.shape;
    const bool even =
        shape.parametrization == Parametrization::uniform || samples.spacing == Spacing::even;
    if (shape.parameters || even) return problem.parameters;
    const std::vector<Closure>& closures = problem.axes.closures;
    Parameters result;
    for (std::size_t k = 0; k < samples.grid.size(); ++k)
        result.axes.push_back(median_chords(samples, k, closures[k]));
    return result;
}

std::vector<KnotVector> robust_knots(const Problem& problem, const Parameters& parameters) {
    const std::vector<int>& degree = problem.axes.degree;
    const std::vector<Closure>& closures = problem.axes.closures;
    std::vector<KnotVector> axes;
    for (std::size_t k = 0; k < degree.size(); ++k) {
        const Index least = 2 * degree[k] + 1;
        const bool closed = closures[k] == Closure::closed;
        if (parameters.is_scattered()) {
            const PointSet box = bounding_box(parameters.scattered);
            const auto axis = static_cast<Index>(k);
            axes.push_back(uniform_knots(
                degree[k], std::max(least, static_cast<Index>(samples_along(problem, k) / 3)),
                closed ? 0 : box(0, axis), closed ? 1 : box(1, axis), closures[k]));
            continue;
        }
        const std::vector<double> t = without_repeats(parameters.axes[k]);
        const auto m = static_cast<Index>(t.size());
        const Index n = std::min(m, std::max(least, m / 2));
        axes.push_back(
            knots_from_parameters(t, degree[k], n, closures[k], KnotPlacement::both_ends));
    }
    return axes;
}

PointSet fitted_values(const Spline& spline, const Parameters& parameters) {
    if (parameters.is_scattered()) return evaluate(spline, parameters.scattered);
    return evaluate_grid(spline, parameters.axes);
}

Spline robust_spline(const Samples& samples, const Parameters& parameters,
                     const std::vector<KnotVector>& axes, double least) {
    constexpr int most_rounds = 60;
    constexpr int last_rounds = 6; // at the final reach
    Samples pseudo = samples;
    Spline spline;
    double reach = 0;
    int at_last_reach = 0;
    for (int round = 0; round < most_rounds && at_last_reach < last_rounds; ++round) {
        spline = least_squares_spline(axes, pseudo, parameters);
        const PointSet fitted = fitted_values(spline, parameters);
        std::vector<double> residual(static_cast<std::size_t>(samples.size()));
        for (Index i = 0; i < samples.size(); ++i)
            residual[static_cast<std::size_t>(i)] = distance(samples.points[i], fitted[i]);
        const double final_reach = 4.685 * std::max(1.4826 * median(residual), least / 3);
        reach = round == 0 ? *std::ranges::max_element(residual) : 0.75 * reach;
        if (reach <= final_reach) {
            reach = final_reach;
            ++at_last_reach;
        }
        PointSet next = fitted;
        for (Index i = 0; i < samples.size(); ++i) {
            const double w = weight(residual[static_cast<std::size_t>(i)], reach);
            for (Index d = 0; d < samples.dim(); ++d)
                next(i, d) += w * (samples.points(i, d) - fitted(i, d));
        }
        pseudo.points = std::move(next);
    }
    return spline;
}

} // namespace batten
