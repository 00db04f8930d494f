#pragma once

#include <batten/basis/basis_functions.hpp>

#include <array>

namespace batten {

/// Position of the pair (i, j), i <= j, among those of 0 to the degree.
inline Index pair_row(Index i, Index j, int degree) {
    return i * (degree + 1) - i * (i - 1) / 2 + (j - i);
}

/// The B-splines on one knot span in the Chebyshev polynomials T_k of the span's own parameter s in
/// [-1, 1].
///
/// Sums of T_k(s), k to 2p, over the span's samples are all that their Gram block needs, and sums
/// of T_k(s) q, k to p, all that its right-hand side needs: no basis function is evaluated per
/// sample. Chebyshev polynomials keep this well-conditioned at any degree.
class ChebyshevMaps {
  public:
    ChebyshevMaps(const KnotVector& knots, Index span);

    /// Coefficients of B_i in T_0 ... T_p.
    const double* coefficients(int i) const { return values_.data() + i * (p_ + 1); }
    double middle() const { return middle_; }
    /// s = (t - middle) * scale.
    double scale() const { return scale_; }

  protected:
    int p_;

  private:
    double middle_;
    double scale_;
    std::array<double, (max_degree + 1) * (max_degree + 1)> values_;
};

/// The same with the products of any two of them.
class ChebyshevPairs : public ChebyshevMaps {
  public:
    ChebyshevPairs(const KnotVector& knots, Index span);

    /// Value of pair (i, j), 0 <= i <= j <= p, from the moments sum T_0 ... sum T_2p (stride
    /// apart): sum of B_i B_j.
    double pair(int i, int j, const double* moments, Index stride = 1) const {
        const double* row = pairs_.data() + pair_row(i, j, p_) * (2 * p_ + 1);
        double sum = 0;
        for (int k = 0; k <= 2 * p_; ++k) sum += row[k] * moments[k * stride];
        return sum;
    }
    /// Coefficients of B_i B_j, i <= j, in T_0 ... T_2p.
    const double* pair_coefficients(int i, int j) const {
        return pairs_.data() + pair_row(i, j, p_) * (2 * p_ + 1);
    }

  private:
    std::array<double, (max_degree + 1) * (max_degree + 2) / 2 * (2 * max_degree + 1)> pairs_;
};

} // namespace batten
