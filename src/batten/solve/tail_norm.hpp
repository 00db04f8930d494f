#pragma once

#include <batten/core/index.hpp>
#include <batten/solve/rotation.hpp>

#include <vector>

namespace batten {

/// The norm of R^{-T} v for rows v of the band of R, upper triangular: what columns further down
/// make of a v that has entries in the next ones only is a small triangle T with |T v| =
/// |R^{-T} v|, which grows row by row from R's last one upwards: T^T T are the entries of
/// (R^T R)^{-1} within the band, as Takahashi's equations give them [ErismanTinney1975], but as an
/// orthogonal factor, which keeps the digits. O(width^2) a row.
class TailNorm {
  public:
    /// R has rows of degree + 1 entries from the diagonal on, and so many of its last columns
    /// beside them.
    TailNorm(int degree, Index border);

    /// Takes the next row upwards of the border's triangle, of which `c` is the diagonal's place.
    void prepend_border(Index c, const Extended* row);
    /// Takes the next row upwards of the band.
    void prepend(const Extended* row);
    /// |R^{-T} v|^2 of a row v that begins where `row` does, the next one upwards of the band.
    Extended squares_of(const Extended* row, const Extended* v) const;
    /// Of a row that has entries in the border only.
    Extended squares_of_border(const Extended* v) const;

  private:
    /// T's row times so much of the entries after the first of a row of the band.
    Extended product(Index k, const Extended* row) const;
    Extended* triangle(Index k) { return triangle_.data() + k * width_; }
    const Extended* triangle(Index k) const { return triangle_.data() + k * width_; }

    Index degree_;
    Index border_;
    Index width_;                    // the next degree columns, then the border's
    std::vector<Extended> triangle_; // (width + 1) x width, the last row a place to work
};

} // namespace batten
