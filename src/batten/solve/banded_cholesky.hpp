#pragma once

#include <batten/system/banded_matrix.hpp>

namespace batten {

/// Cholesky factor of a symmetric positive definite banded matrix; a closed axis is bordered by its
/// last bandwidth rows, so that factor and solves cost O(n bandwidth^2) and O(n bandwidth).
class BandedCholesky {
  public:
    /// Throws SolverError naming the row when a pivot is not positive, or is below 1e-14 of its
    /// diagonal entry.
    explicit BandedCholesky(const BandedMatrix& matrix);

    /// x = M^{-1} b in place along one axis, (outer x n x inner).
    void solve(double* x, AxisLayout layout) const;

  private:
    void factor_band(const BandedMatrix& matrix);
    void factor_border(const BandedMatrix& matrix);
    void solve_one(double* x, Index inner) const;

    Index size_;
    Index border_; // rows factored densely at the end; 0 for an open axis
    int bandwidth_;
    std::vector<double> band_;   // L(i, i - k) at i * (bandwidth + 1) + k, diagonal inverted
    std::vector<double> corner_; // the border rows of L, (border x n), diagonal inverted
};

} // namespace batten
