#include <batten/solve/direct.hpp>

#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <Eigen/Dense>

namespace batten {

PointSet solve_direct(const NormalSystem& system) {
    return factorize(system)->solve(system.rhs());
}

namespace {

/// Lengths of the directions that leave the least error: the energy above the unconstrained
/// minimum is (C P - d)^T S^{-1} (C P - d), quadratic in them.
std::vector<double> best_lengths(const Constraints& constraints, const PointSet& unconstrained,
                                 const SchurComplement& schur) {
    const std::vector<Index>& rows = constraints.directions();
    const auto count = static_cast<Index>(rows.size());
    PointSet gap = constraints.apply(unconstrained);
    add_scaled(gap, -1.0, constraints.with_lengths(std::vector<double>(rows.size(), 0.0)).values());
    const PointSet pull = schur.solve(gap);
    PointSet units(constraints.size(), count);
    for (Index k = 0; k < count; ++k) units(rows[static_cast<std::size_t>(k)], k) = 1;
    const PointSet inverse = schur.solve(units);
    Eigen::MatrixXd matrix(count, count);
    Eigen::VectorXd right(count);
    const auto direction = [&](Index k) {
        return constraints.values()[rows[static_cast<std::size_t>(k)]];
    };
    const auto dot = [](std::span<const double> a, std::span<const double> b) {
        double sum = 0;
        for (std::size_t d = 0; d < a.size(); ++d) sum += a[d] * b[d];
        return sum;
    };
    for (Index k = 0; k < count; ++k) {
        const Index row = rows[static_cast<std::size_t>(k)];
        right[k] = dot(direction(k), pull[row]);
        for (Index l = 0; l < count; ++l)
            matrix(k, l) = inverse(row, l) * dot(direction(k), direction(l));
    }
    const Eigen::VectorXd lengths = matrix.ldlt().solve(right);
    return {lengths.begin(), lengths.end()};
}

} // namespace

PointSet solve_direct(const NormalSystem& system, const Constraints& given) {
    if (given.empty()) return solve_direct(system);
    const Constraints independent = given.independent(system.size());
    const auto normal = factorize(system);
    const SchurComplement schur(*normal, independent, system.size());
    PointSet control = normal->solve(system.rhs());
    const Constraints constraints =
        independent.directions().empty()
            ? independent
            : independent.with_lengths(best_lengths(independent, control, schur));
    // the second pass takes up what rounding left of the constraints
    for (int pass = 0; pass < 2; ++pass) {
        PointSet gap = constraints.apply(control);
        add_scaled(gap, -1.0, constraints.values());
        const PointSet multipliers = schur.solve(gap);
        add_scaled(control, -1.0,
                   normal->solve(constraints.apply_transposed(multipliers, system.size())));
    }
    return control;
}

Constraints with_best_lengths(const NormalSystem& system, const Constraints& given) {
    if (given.directions().empty()) return given;
    const auto normal = factorize(system);
    const SchurComplement schur(*normal, given, system.size());
    return given.with_lengths(best_lengths(given, normal->solve(system.rhs()), schur));
}

} // namespace batten
