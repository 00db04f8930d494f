#pragma once

#include <batten/solve/factorization.hpp>
#include <batten/system/constraints.hpp>

namespace batten {

/// S = C (A^T D A)^{-1} C^T, the matrix (k x k) of the multipliers' equations: along one axis in
/// the saddle point's band, else dense. What it is made of must outlive it.
class SchurComplement {
  public:
    SchurComplement(const Factorization& normal, const Constraints& constraints, Index controls);
    ~SchurComplement();
    SchurComplement(const SchurComplement&) = delete;
    SchurComplement& operator=(const SchurComplement&) = delete;

    /// S^{-1} b for b (k x dim).
    PointSet solve(const PointSet& b) const;
    /// The largest eigenvalue, to 1e-9 of it or, of many constraints along one axis, 1e-3.
    double largest_eigenvalue() const;

  private:
    struct Matrix;
    /// S x for x (k x dim).
    PointSet apply(const PointSet& x) const;

    const Factorization& normal_;
    const Constraints& constraints_;
    Index controls_;
    std::unique_ptr<BandedSaddle> band_;
    std::unique_ptr<Matrix> matrix_; ///< where there is no band
};

/// The control points moved, as little as the normal equations weigh it, until what they lack of
/// the constraints is rounding.
PointSet onto_constraints(PointSet control, const Constraints& constraints,
                          const Factorization& normal, const SchurComplement& schur);

} // namespace batten
