#include <batten/solve/cross_validation.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/solve/factor_search.hpp>
#include <batten/solve/residual_system.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace batten {

namespace {

Smoothing judged(const NormalSystem& system, double lambda, const Quality& quality) {
    const auto m = static_cast<double>(system.sample_count());
    const double mean_square = quality.squares / total_weight(system);
    return {lambda, quality.trace, quality.axis_traces, noise_left(mean_square, m, quality.trace)};
}

/// Even knots for at most so many control points per axis.
std::vector<KnotVector> coarser(const std::vector<KnotVector>& axes, Index per_axis) {
    std::vector<KnotVector> result;
    for (const KnotVector& axis : axes)
        result.push_back(
            axis.free_count() <= per_axis
                ? axis
                : uniform_knots(axis.degree(), per_axis, axis.begin(), axis.end(), axis.closure()));
    return result;
}

/// V of the system's least squares without smoothing, for samples of which a spline leaves the
/// rest: their reduction by preconditioned conjugate gradients.
double score_of_all(const NormalSystem& system, const Spline& spline, const Samples& samples,
                    const Parameters& parameters) {
    constexpr int rounds = 40;
    const auto m = static_cast<double>(samples.size());
    const double left = 1 - static_cast<double>(system.size()) / m;
    const auto rest = residual_system(spline, system.axes(), samples, parameters);
    const auto nearby = factorize_axes(*rest);
    if (!(left > 0) || !nearby) return std::numeric_limits<double>::infinity();
    PointSet control(rest->size(), rest->dim());
    PointSet gradient = rest->rhs();
    PointSet direction = nearby->solve(gradient);
    PointSet image(rest->size(), rest->dim());
    double slope = inner_product(gradient, direction);
    for (int round = 0; round < rounds && slope > 0; ++round) {
        rest->apply(direction, image);
        const double part = slope / inner_product(direction, image);
        add_scaled(control, part, direction);
        add_scaled(gradient, -part, image);
        PointSet next = nearby->solve(gradient);
        const double before = std::exchange(slope, inner_product(gradient, next));
        add_scaled(next, slope / before, direction);
        direction = std::move(next);
    }
    return (rest->data_energy() + rest->energy(control)) / m / left / left;
}

/// The choice on a coarser net that bears it: one that has a few control points per degree of
/// freedom along each axis, where all control points of the finer net without smoothing do no
/// better; none where there is no such net.
std::optional<Smoothing> chosen_on_coarser(const NormalSystem& system, const Samples& samples,
                                           const Parameters& parameters, int order) {
    constexpr Index first = 48;
    constexpr double per_freedom = 4;
    std::optional<double> last;
    for (Index per_axis = first;; per_axis *= 2) {
        const std::vector<KnotVector> axes = coarser(system.axes(), per_axis);
        const auto coarse = assemble(axes, samples, parameters);
        if (coarse->size() > system.size() / 2) return {};
        FactorSearch search(*coarse, samples, parameters, order);
        const double best = last ? search.lowest(search.descended(search.doublings(*last)))
                                 : search.levelled(search.scanned());
        const Quality quality = search.quality(best);
        if (!std::isfinite(quality.squares)) return {};
        last = search.factor(best);
        const double along = std::pow(quality.trace, 1 / static_cast<double>(axes.size()));
        if (along * per_freedom > static_cast<double>(per_axis)) continue;
        const auto smoothed = coarse->clone();
        smoothed->add_roughness(*last, order);
        const Spline spline = Spline::from_free(
            axes, uncentred(factorize(*smoothed)->solve(coarse->rhs()), coarse->centre()));
        if (score_of_all(system, spline, samples, parameters) < search.score(best)) return {};
        return judged(system, *last, quality);
    }
}

} // namespace

double noise_left(double mean_square, double m, double freedom) {
    return std::sqrt(mean_square * m / std::max(1.0, m - freedom));
}

Smoothing cross_validated(const NormalSystem& system, const Samples& samples,
                          const Parameters& parameters, int order) {
    constexpr Index few = 5000; // control points whose factorisation costs little
    if (system.factors().empty() && parameters.is_scattered() && system.size() > few)
        if (const auto coarse = chosen_on_coarser(system, samples, parameters, order))
            return *coarse;
    FactorSearch search(system, samples, parameters, order);
    const double best = search.levelled(search.scanned());
    const Quality chosen = search.quality(best);
    if (!std::isfinite(chosen.squares))
        throw SolverError("no smoothing makes the samples determine every control point");
    return judged(system, search.factor(best), chosen);
}

Smoothing smoothed_by(double lambda, const NormalSystem& system, const Samples& samples,
                      const Parameters& parameters, int order) {
    return judged(system, lambda, (*smoothing_quality(system, samples, parameters, order))(lambda));
}

} // namespace batten
