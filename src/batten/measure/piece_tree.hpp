#pragma once

#include <batten/spline/bezier_pieces.hpp>

namespace batten {

/// Boxes around a spline's polynomial pieces, around blocks of neighbouring pieces, and so on up to
/// one group: in groups of eight, so that their distances from a point are found together.
class PieceTree {
  public:
    static constexpr Index group_size = 8;

    explicit PieceTree(const BezierPieces& pieces);

    /// Levels of groups; level 0 holds the boxes of pieces, the last is a single group.
    Index height() const { return static_cast<Index>(levels_.size()); }

    /// Lower bounds of the squared distances from the point (dim) to what is in the group's boxes,
    /// infinite for unused ones.
    std::array<double, group_size> squares(Index level, Index group, const double* point) const;

    /// The group of the level below, or on level 0 the piece, that a box of the group stands for.
    Index below(Index level, Index group, Index box) const {
        return levels_[static_cast<std::size_t>(level)]
            .below[static_cast<std::size_t>(group * group_size + box)];
    }

  private:
    struct Level {
        std::vector<Index> below;  // per box
        std::vector<double> boxes; // per group: dim x {low, high} x group_size
    };

    void add_level(const PerAxis<Index>& below, const PerAxis<Index>& shape,
                   const PerAxis<Index>& block);
    void bound_pieces(const BezierPieces& pieces, Level& level) const;
    void bound_groups(const Level& below, Level& level) const;

    Index dim_;
    std::vector<Level> levels_;
};

} // namespace batten
