#pragma once

#include <batten/system/banded_matrix.hpp>
#include <batten/system/constraints.hpp>

#include <array>
#include <span>

namespace batten {

/// A linear inequality on three neighbouring points of the plane: the sum of `part` times their
/// coordinates x, y, x, y, x, y is `least` or more.
struct TurnRow {
    Index first = 0; ///< of the points, which go around the end of a closed polygon
    std::array<double, 6> part{};
    double least = 0;
};

/// The moves (n x 2) of points that `gram` (n x n) weighs least, 1/2 sum of d^T gram d over both
/// coordinates, that have all the inequalities and leave what `held` is a sum of: a quadratic
/// program by a primal-dual interior point method [Mehrotra1992], every step one banded system, and
/// then by the inequalities that it shows to be tight, to rounding. Where these do not settle, or
/// the inequalities contradict each other, it is what the method came to.
PointSet least_moves(const BandedMatrix& gram, std::span<const TurnRow> rows,
                     const Constraints& held);

} // namespace batten
