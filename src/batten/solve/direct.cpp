#include <batten/solve/direct.hpp>

#include <batten/core/vectors.hpp>
#include <batten/solve/condition.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace batten {

PointSet solve_direct(const NormalSystem& system) {
    return factorize(system)->solve(system.rhs());
}

namespace {

/// Lengths of the directions that leave the least error: the energy above the unconstrained
/// minimum is (C P - d)^T S^{-1} (C P - d), quadratic in them. A length that would turn its
/// direction round, or all but vanish, becomes a small part of the unconstrained derivative's.
std::vector<double> best_lengths(const Constraints& constraints, const PointSet& unconstrained,
                                 const SchurComplement& schur) {
    constexpr double small_part = 0.1;
    const std::vector<Index>& rows = constraints.directions();
    const auto count = static_cast<Index>(rows.size());
    const auto row_of = [&](Index k) { return rows[static_cast<std::size_t>(k)]; };
    const PointSet free_values = constraints.apply(unconstrained);
    PointSet gap = free_values;
    add_scaled(gap, -1.0, constraints.with_lengths(std::vector<double>(rows.size(), 0.0)).values());
    const PointSet pull = schur.solve(gap);
    PointSet units(constraints.size(), count);
    for (Index k = 0; k < count; ++k) units(row_of(k), k) = 1;
    const PointSet inverse = schur.solve(units);
    Eigen::MatrixXd matrix(count, count);
    Eigen::VectorXd right(count);
    Eigen::VectorXd least(count);
    for (Index k = 0; k < count; ++k) {
        const auto direction = constraints.values()[row_of(k)];
        const auto derivative = free_values[row_of(k)];
        right[k] = dot(direction, pull[row_of(k)]);
        least[k] = small_part * norm(derivative);
        for (Index l = 0; l < count; ++l)
            matrix(k, l) = inverse(row_of(k), l) * dot(direction, constraints.values()[row_of(l)]);
    }
    Eigen::VectorXd lengths = matrix.ldlt().solve(right);
    std::vector<bool> held(static_cast<std::size_t>(count), false);
    for (bool any = true; any;) {
        any = false;
        for (Index k = 0; k < count; ++k)
            if (!held[static_cast<std::size_t>(k)] && !(lengths[k] >= least[k])) {
                held[static_cast<std::size_t>(k)] = true;
                any = true;
            }
        if (!any) break;
        Eigen::MatrixXd reduced = matrix;
        Eigen::VectorXd rest = right;
        for (Index k = 0; k < count; ++k)
            if (held[static_cast<std::size_t>(k)]) {
                rest -= matrix.col(k) * least[k];
                reduced.row(k).setZero();
                reduced.col(k).setZero();
                reduced(k, k) = 1;
            }
        for (Index k = 0; k < count; ++k)
            if (held[static_cast<std::size_t>(k)]) rest[k] = least[k];
        lengths = reduced.ldlt().solve(rest);
    }
    return {lengths.begin(), lengths.end()};
}

/// Control points of the unconstrained minimum, moved to that under independent constraints.
PointSet constrained(PointSet control, const Factorization& normal,
                     const Constraints& independent) {
    if (independent.empty()) return control;
    const SchurComplement schur(normal, independent, control.size());
    const Constraints constraints =
        independent.directions().empty()
            ? independent
            : independent.with_lengths(best_lengths(independent, control, schur));
    return onto_constraints(std::move(control), constraints, normal, schur);
}

/// Factors of the normal equations where these keep half of a number's digits, or ten where
/// smoothing or weights make them lose some; null where the rows are needed.
std::unique_ptr<Factorization> factors_that_keep(const NormalSystem& system, bool plain) {
    const double most = plain ? 1 / std::sqrt(std::numeric_limits<double>::epsilon()) : 1e6;
    const bool has_rows = !system.factors().empty();
    try {
        auto normal = factorize(system);
        if (!has_rows || inverse_norm(system, *normal) <= most) return normal;
    } catch (const SolverError&) {
        if (!has_rows) throw;
    }
    return nullptr;
}

/// These, or else factors of the rows.
struct Solver {
    std::unique_ptr<Factorization> normal;
    std::unique_ptr<RowFactorization> rows;

    Solver(const NormalSystem& system, const SampleRows& of) {
        const bool plain = of.lambda == 0 && of.samples.weights.empty();
        normal = factors_that_keep(system, plain);
        if (normal) return;
        rows = std::make_unique<RowFactorization>(system.axes(), of, system.centre());
        if (!plain) return;
        for (const BandedQr& axis : rows->axes()) axis.check();
        constexpr double hopeless = 1e26; // an axis's squared condition that leaves no digits
        if (!(inverse_norm(system, *rows) <
              std::pow(hopeless, static_cast<double>(system.axes().size()))))
            throw SolverError("the least-squares problem is singular: in all it determines no "
                              "digits of some control points");
    }
    const Factorization& factors() const { return rows ? *rows : *normal; }
    PointSet solution(const NormalSystem& system) const {
        return rows ? rows->solution() : normal->solve(system.rhs());
    }
};

} // namespace

PointSet solve_direct(const NormalSystem& system, const Constraints& given) {
    const Constraints independent = given.empty() ? given : given.independent(system.size());
    const auto normal = factorize(system);
    return constrained(normal->solve(system.rhs()), *normal, independent);
}

PointSet solve_direct(const NormalSystem& system, const SampleRows& rows,
                      const Constraints& given) {
    const Constraints independent = given.empty() ? given : given.independent(system.size());
    const Solver solver(system, rows);
    return constrained(solver.solution(system), solver.factors(), independent);
}

std::optional<PointSet> solve_direct_without_rows(const NormalSystem& system, bool weighted) {
    const auto normal = factors_that_keep(system, !weighted);
    if (!normal) return std::nullopt;
    return normal->solve(system.rhs());
}

double freedom_held(const NormalSystem& samples, const NormalSystem& smoothed,
                    const SampleRows& rows, const Constraints& given) {
    if (given.empty()) return 0;
    const Constraints independent = given.independent(samples.size());
    const Solver solver(smoothed, rows);
    const SchurComplement schur(solver.factors(), independent, samples.size());
    PointSet unit(independent.size(), independent.size());
    for (Index i = 0; i < unit.size(); ++i) unit(i, i) = 1;
    const PointSet pulls =
        solver.factors().solve(independent.apply_transposed(unit, samples.size()));
    PointSet images(pulls.size(), pulls.dim());
    samples.apply(pulls, images);
    const PointSet moved =
        schur.solve(independent.apply(solver.factors().solve(std::move(images))));
    double sum = 0;
    for (Index i = 0; i < moved.size(); ++i) sum += moved(i, i);
    return sum;
}

Constraints with_best_lengths(const NormalSystem& system, const Constraints& given) {
    if (given.directions().empty()) return given;
    const auto normal = factorize(system);
    const SchurComplement schur(*normal, given, system.size());
    return given.with_lengths(best_lengths(given, normal->solve(system.rhs()), schur));
}

} // namespace batten
