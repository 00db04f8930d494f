#include <batten/robust/robust_fit.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/problem/plan.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

Spline least_squares_spline(const std::vector<KnotVector>& axes, const Samples& samples,
                            const Parameters& parameters) {
    const auto system = assemble(axes, samples, parameters);
    PointSet control(system->size(), system->dim());
    ConjugateGradients cg(*system, Preconditioner::axes);
    iterate(cg, control, {.max_iterations = 200, .relative_gradient = 1e-8});
    return Spline::from_free(axes, uncentred(control, system->centre()));
}

/// Tukey's weight: nothing beyond `reach`.
double weight(double residual, double reach) {
    const double part = 1 - residual * residual / (reach * reach);
    return part > 0 ? part * part : 0;
}

} // namespace

std::vector<KnotVector> robust_knots(const Problem& problem, const Parameters& parameters) {
    const std::vector<int>& degree = problem.axes.degree;
    const std::vector<Closure>& closures = problem.axes.closures;
    std::vector<KnotVector> axes;
    for (std::size_t k = 0; k < degree.size(); ++k) {
        const Index least = 2 * degree[k] + 1;
        const bool closed = closures[k] == Closure::closed;
        const PointSet box = bounding_box(parameters.scattered);
        const auto axis = static_cast<Index>(k);
        axes.push_back(uniform_knots(
            degree[k], std::max(least, static_cast<Index>(samples_along(problem, k) / 3)),
            closed ? 0 : box(0, axis), closed ? 1 : box(1, axis), closures[k]));
    }
    return axes;
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
        const PointSet fitted = evaluate(spline, parameters.scattered);
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
