#pragma once

#include <batten/core/core.hpp>
#include <batten/robust/local_process.hpp>
#include <batten/robust/neighbours.hpp>

#include <array>
#include <vector>

namespace batten {

/// Samples of a cloud, those that are near each other in a row, of which some are trusted, and what
/// these say of each other and of the rest.
class TrustedCloud {
  public:
    struct Neighbour {
        double square; ///< of its distance
        Index sample;
    };
    /// Nearest first; one is used again and again.
    using Neighbours = std::vector<Neighbour>;

    /// All samples; places are (m x 1 to 3).
    TrustedCloud(const Points& points, const Points& places);

    Index size() const { return places_.size(); }
    /// What the sample was numbered before.
    Index original(Index sample) const { return order_[static_cast<std::size_t>(sample)]; }
    bool trusts(Index sample) const { return trusted_[static_cast<std::size_t>(sample)] != 0; }
    void trust(Index sample, bool yes) { trusted_[static_cast<std::size_t>(sample)] = yes ? 1 : 0; }

    /// The nearest trusted samples but itself, and those that are as far as the last; fewer where
    /// there are no more.
    void nearest(Index sample, Index count, Neighbours& found) const;

    /// How far a sample is from where its nearest trusted ones have it by a polynomial of second
    /// degree, three to each of its terms; does not exist where they do not determine it.
    Prediction predict(Index sample, Neighbours& found) const;

    /// So many neighbours make a process.
    Index process_size() const { return 24 * std::max<Index>(2, places_.dim()); }
    /// Through these neighbours of a sample.
    LocalProcess process(Index sample, const Neighbours& neighbours) const;

  private:
    using Cell = std::array<Index, 3>;
    Cell cell(std::span<const double> place) const;
    double clear(Index sample, const Cell& low, const Cell& high) const;

    PointSet points_;
    PointSet places_;
    std::vector<Index> order_;
    std::vector<char> trusted_;
    std::array<double, 3> low_{};
    double width_ = 1;         ///< of a cell
    GridIndex cells_;          ///< cubes, the last axis of the places along the last one
    std::vector<Index> first_; ///< of each cell's samples
};

} // namespace batten
