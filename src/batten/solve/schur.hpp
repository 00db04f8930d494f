#pragma once

#include <batten/solve/extreme_eigenvalues.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/system/constraints.hpp>

namespace batten {

/// C (A^T D A)^{-1} C^T, the small dense matrix (k x k) of the multipliers' equations.
class SchurComplement {
  public:
    SchurComplement(const Factorization& normal, const Constraints& constraints, Index controls);
    ~SchurComplement();
    SchurComplement(const SchurComplement&) = delete;
    SchurComplement& operator=(const SchurComplement&) = delete;

    /// S^{-1} b for b (k x dim).
    PointSet solve(const PointSet& b) const;
    ExtremeEigenvalues eigenvalues() const;

  private:
    struct Matrix;
    std::unique_ptr<Matrix> matrix_;
};

/// The control points moved, as little as the normal equations weigh it, until what they lack of
/// the constraints is rounding.
PointSet onto_constraints(PointSet control, const Constraints& constraints,
                          const Factorization& normal, const SchurComplement& schur);

} // namespace batten
