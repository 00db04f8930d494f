#include <batten/solve/cross_validation.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/solve/factor_search.hpp>
#include <batten/solve/residual_system.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
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

/// About one sample in `part`, the same in every run.
std::pair<Samples, Parameters> thinned(const Samples& samples, const Parameters& parameters,
                                       unsigned part) {
    std::mt19937_64 random(1);
    std::vector<double> points;
    std::vector<double> scattered;
    Samples some;
    for (Index i = 0; i < samples.size(); ++i) {
        if (random() % part != 0) continue;
        const auto at = samples.points[i];
        const auto t = parameters.scattered[i];
        points.insert(points.end(), at.begin(), at.end());
        scattered.insert(scattered.end(), t.begin(), t.end());
        if (!samples.weights.empty())
            some.weights.push_back(samples.weights[static_cast<std::size_t>(i)]);
    }
    some.points = PointSet(std::move(points), samples.dim());
    return {std::move(some), {{}, PointSet(std::move(scattered), parameters.scattered.dim())}};
}

/// A factor near the best one of a cloud: of coarser nets through so many samples fewer, until one
/// has a few control points per degree of freedom along each axis; none where no samples are left.
std::optional<double> coarsely_chosen(const NormalSystem& system, const Samples& samples,
                                      const Parameters& parameters, int order) {
    constexpr double per_freedom = 4;
    const std::size_t count = system.axes().size();
    const auto axes_count = static_cast<double>(count);
    std::optional<double> last; // for all samples
    for (int halvings = 2; halvings > 0; --halvings) {
        std::vector<KnotVector> axes;
        double most = 1; // control points along an axis
        for (const KnotVector& axis : system.axes()) {
            const Index n = std::max<Index>(axis.free_count() >> halvings, axis.degree() + 1);
            axes.push_back(
                uniform_knots(axis.degree(), n, axis.begin(), axis.end(), axis.closure()));
            most *= static_cast<double>(n);
        }
        most = std::pow(most, 1 / axes_count);
        const auto [some, places] =
            thinned(samples, parameters, 1U << static_cast<unsigned>(count) * halvings);
        if (some.size() == 0) continue;
        // noise of variance s / m is smoothed by (s / m)^(2 r / (2 r + d)) [Wahba1990]
        const double more =
            std::pow(static_cast<double>(some.size()) / static_cast<double>(samples.size()),
                     2 * order / (2 * order + axes_count));
        const auto coarse = assemble(axes, some, places);
        FactorSearch search(*coarse, some, places, order);
        const double best = search.telling(
            search.settled(last ? search.doublings(*last / more) : search.scanned()));
        last = search.factor(best) * more;
        if (std::pow(search.quality(best).trace, 1 / axes_count) * per_freedom <= most) break;
    }
    return last;
}

} // namespace

double noise_left(double mean_square, double m, double freedom) {
    return std::sqrt(mean_square * m / std::max(1.0, m - freedom));
}

Smoothing cross_validated(const NormalSystem& system, const Samples& samples,
                          const Parameters& parameters, int order) {
    constexpr Index few = 5000;     // control points whose factorisation costs little
    constexpr Index many = 1 << 16; // much
    const bool large_cloud = parameters.is_scattered() && system.size() > few;
    if (large_cloud && system.size() > many)
        if (const auto coarse = chosen_on_coarser(system, samples, parameters, order))
            return *coarse;
    FactorSearch search(system, samples, parameters, order);
    double best = 0;
    if (large_cloud)
        if (const auto near = coarsely_chosen(system, samples, parameters, order))
            best = search.settled(search.doublings(*near));
    if (!large_cloud || !std::isfinite(search.score(best)))
        best = search.levelled(search.scanned());
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
