#pragma once

#include <batten/core/core.hpp>

#include <array>
#include <span>
#include <vector>

namespace batten {

/// What a place's coordinates are times where distances are taken; (1 to 3) are read.
using Metric = std::array<double, 3>;

/// Scattered places (m x 1 to 3), those near each other in a row, and which are nearest to which
/// [Bentley1975].
class PlaceTree {
  public:
    struct Neighbour {
        double square; ///< of its distance
        Index place;
    };
    /// Nearest first; one is used again and again.
    using Neighbours = std::vector<Neighbour>;

    explicit PlaceTree(const Points& places);

    /// In the tree's order, as every index here.
    const PointSet& places() const { return places_; }
    Index size() const { return places_.size(); }
    /// What the place was numbered before.
    Index original(Index place) const { return order_[static_cast<std::size_t>(place)]; }

    /// The nearest to a place that are wanted (one mark per place) but itself, and those that are
    /// as far as the last, if not too many; eight at most that are the same. Fewer where there are
    /// no more.
    void nearest(Index place, Index count, const Metric& metric, std::span<const char> wanted,
                 Neighbours& found) const;

  private:
    static constexpr Index most_alike = 8;
    static constexpr int leaf = -1;

    /// Its first half follows it.
    struct Node {
        Index begin;
        Index end;
        int axis = leaf;
        double below = 0; ///< the last of the first half along the axis
        double above = 0; ///< the first of the second
        Index second = 0;
    };
    struct Placed {
        std::array<double, 3> at;
        Index number;
    };
    struct Search;
    void divide(std::span<Placed> all, Index begin, Index end);

    PointSet places_;
    std::vector<Index> order_;
    std::vector<Node> nodes_;
};

} // namespace batten
