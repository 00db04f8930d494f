#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/solve/rotation.hpp>
#include <batten/system/constraints.hpp>

#include <vector>

namespace batten {

/// The saddle point's equations (H C^T; C 0) of a banded H, open or cyclic, and constraints on
/// neighbouring control points: every multiplier stands behind the last control point that it pulls
/// on, those of a cyclic H alternate from both ends, so that all is one band, whose LU factors with
/// row interchanges [GolubVanLoan2013, section 4.3.5] cost O((n + k) bandwidth^2).
class BandedSaddle {
  public:
    using Visit = FunctionRef<void(Index row, Index column, Extended value)>;

    /// `for_each_entry` calls its argument for the entries of H (n x n), both above and below the
    /// diagonal; entries told for one place add up.
    BandedSaddle(Index n, Closure closure, FunctionRef<void(Visit)> for_each_entry,
                 const Constraints& constraints);

    /// The multipliers y of H x + C^T y = 0, C x = b, for b (k x dim): -S^{-1} b, S = C H^{-1} C^T.
    PointSet multipliers(const PointSet& b) const;

  private:
    Extended& at(Index row, Index column) {
        return band_[static_cast<std::size_t>(row * width_ + column - row + below_)];
    }
    Extended at(Index row, Index column) const {
        return band_[static_cast<std::size_t>(row * width_ + column - row + below_)];
    }
    void place(Index n, Closure closure, const Constraints& constraints);
    void factor();

    Index size_ = 0;
    Index below_ = 0; // entries below the diagonal, and above it before rows are interchanged
    Index width_ = 0;
    std::vector<Index> controls_;    // where they stand
    std::vector<Index> multipliers_; // where these do
    std::vector<Extended> band_;     // U and the factors of L, row by row
    std::vector<Index> pivots_;      // the row that each one was interchanged with
};

} // namespace batten
