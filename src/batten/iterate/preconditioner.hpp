#pragma once

#include <batten/solve/factorization.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

enum class Preconditioner {
    none,
    diagonal,
    /// The Kronecker product of the axes' own matrices, for scattered samples: near the inverse
    /// where they are spread evenly. Falls back to the diagonal where an axis alone is singular, or
    /// for systems that are solved axis by axis anyway.
    axes,
};

/// The inverse M^{-1} of a matrix near A^T D A that is quickly applied. Control points without
/// samples get 0, so that they stay where they are.
class Preconditioning {
  public:
    Preconditioning() = default;
    Preconditioning(const NormalSystem& system, Preconditioner kind);

    /// M with as many diagonals beside the middle of each banded factor; what is left out counts by
    /// its absolute value on the diagonal instead [AxelssonKolotilina1994]. No eigenvalue of M^{-1}
    /// A^T D A is above 1, and with no diagonals M is that of the row sums. Where the samples leave
    /// such an M singular it has fewer diagonals. For systems with factors.
    static Preconditioning compensated_bands(const NormalSystem& system, int diagonals);

    /// M of the row sums' absolute values alone, as of no diagonals, for any system.
    static Preconditioning row_sums(const NormalSystem& system);

    /// x = M^{-1} x for x (N x dim).
    void apply(PointSet& x) const;
    /// The diagonals of compensated_bands; -1 of any other.
    int diagonals() const { return diagonals_; }

  private:
    std::unique_ptr<Factorization> axes_;
    std::vector<double> inverse_diagonal_; ///< with axes_ only told from 0; empty: all
    int diagonals_ = -1;
};

} // namespace batten
