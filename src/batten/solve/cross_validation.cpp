#include <batten/solve/cross_validation.hpp>

#include <batten/solve/banded_cholesky.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/system/roughness.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace batten {

namespace {

/// Residual sum of squares and trace for one lambda.
struct Quality {
    double squares;
    double trace;
};

double score(const Quality& q, double m) {
    const double left = 1 - q.trace / m;
    return left > 0 ? q.squares / m / (left * left) : std::numeric_limits<double>::infinity();
}

/// The residual from the normal equations, not below what rounding leaves of it.
double residual(const NormalSystem& system, double product, const PointSet& control) {
    return std::max(1e-15 * system.data_energy(),
                    system.data_energy() - 2 * inner_product(control, system.rhs()) + product);
}

/// Trace of (G + lambda R)^{-1} G, column by column.
double trace_of(const BandedMatrix& gram, const BandedCholesky& smoothed) {
    const Index n = gram.size();
    PointSet unit(n, n);
    for (Index i = 0; i < n; ++i) unit(i, i) = 1;
    PointSet columns(n, n);
    gram.apply(unit.data(), columns.data(), {1, n});
    smoothed.solve(columns.data(), {1, n});
    double sum = 0;
    for (Index i = 0; i < n; ++i) sum += columns(i, i);
    return sum;
}

Quality along_axes(const NormalSystem& system, const std::vector<BandedMatrix>& rough,
                   double lambda) {
    const auto grams = system.factors();
    PointSet control = system.rhs();
    double trace = 1;
    for (std::size_t k = grams.size(); k-- > 0;) {
        BandedMatrix sum = *grams[k];
        sum.add(lambda * grams[k]->total(), rough[k]);
        const BandedCholesky factor(sum);
        factor.solve(control.data(), along(system.controls(), k, control.dim()));
        trace *= trace_of(*grams[k], factor);
    }
    PointSet image(control.size(), control.dim());
    system.apply(control, image);
    return {residual(system, inner_product(control, image), control), trace};
}

/// Random signs, the same in every run.
PointSet probes(Index rows) {
    constexpr Index count = 8;
    PointSet result(rows, count);
    std::mt19937_64 random(1);
    for (double& x : result.values()) x = random() % 2 == 0 ? -1 : 1;
    return result;
}

Quality as_a_whole(const NormalSystem& system, double lambda, int order) {
    const auto smoothed = system.clone();
    smoothed->add_roughness(lambda, order);
    const auto factor = factorize(*smoothed);
    const PointSet control = factor->solve(system.rhs());
    PointSet image(control.size(), control.dim());
    system.apply(control, image);
    const PointSet z = probes(system.size());
    PointSet gram_z(z.size(), z.dim());
    system.apply(z, gram_z);
    return {residual(system, inner_product(control, image), control),
            inner_product(z, factor->solve(gram_z)) / static_cast<double>(z.dim())};
}

/// The least of `value` over [low, high]: a scan, then golden sections around its best.
double least(const std::function<double(double)>& value, double low, double high, int scan,
             int sections) {
    const double step = (high - low) / scan;
    double best = low;
    double best_value = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= scan; ++k) {
        const double v = value(low + k * step);
        if (v < best_value) {
            best_value = v;
            best = low + k * step;
        }
    }
    const double golden = (std::sqrt(5.0) - 1) / 2;
    double a = best - step;
    double b = best + step;
    for (int k = 0; k < sections; ++k) {
        const double x = b - golden * (b - a);
        const double y = a + golden * (b - a);
        (value(x) <= value(y) ? b : a) = value(x) <= value(y) ? y : x;
    }
    const double middle = (a + b) / 2;
    return value(middle) <= best_value ? middle : best;
}

} // namespace

Smoothing cross_validated(const NormalSystem& system, int order) {
    const bool factored = !system.factors().empty();
    std::vector<BandedMatrix> rough;
    for (const KnotVector& axis : system.axes()) rough.push_back(roughness_matrix(axis, order));
    const auto m = static_cast<double>(system.sample_count());
    const auto quality = [&](double exponent) -> Quality {
        const double lambda = std::pow(10, exponent);
        try {
            return factored ? along_axes(system, rough, lambda) : as_a_whole(system, lambda, order);
        } catch (const SolverError&) { // too little to hold every control point
            return {std::numeric_limits<double>::infinity(), 0};
        }
    };
    // of parameters over [0, 1] a derivative's square is at most about the samples' number to the
    // power of twice its order: below 1e-16 of the mean square nothing is left of it
    const double best = least([&](double exponent) { return score(quality(exponent), m); }, -16, 2,
                              factored ? 36 : 12, factored ? 16 : 6);
    const Quality chosen = quality(best);
    if (!std::isfinite(chosen.squares))
        throw SolverError("no smoothing makes the samples determine every control point");
    return {std::pow(10, best), chosen.trace,
            std::sqrt(chosen.squares / std::max(1.0, m - chosen.trace))};
}

} // namespace batten
