#include <batten/solve/direct.hpp>

#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

namespace batten {

PointSet solve_direct(const NormalSystem& system) {
    return factorize(system)->solve(system.rhs());
}

PointSet solve_direct(const NormalSystem& system, const Constraints& constraints) {
    if (constraints.empty()) return solve_direct(system);
    constraints.check_independent(system.size());
    const auto normal = factorize(system);
    const SchurComplement schur(*normal, constraints, system.size());
    PointSet control = normal->solve(system.rhs());
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

} // namespace batten
