#pragma once

#include <batten/core/core.hpp>
#include <batten/robust/local_process.hpp>
#include <batten/robust/neighbours.hpp>
#include <batten/robust/place_tree.hpp>

#include <algorithm>
#include <span>
#include <vector>

namespace batten {

/// Samples of a cloud, those that are near each other in a row, of which some are trusted, and what
/// these say of each other and of the rest.
class TrustedCloud {
  public:
    using Neighbours = PlaceTree::Neighbours;

    /// All samples; places are (m x 1 to 3).
    TrustedCloud(const Points& points, const Points& places);

    Index size() const { return tree_.size(); }
    Index axes() const { return tree_.places().dim(); }
    /// In the order of the samples' numbers here.
    const PointSet& points() const { return points_; }
    /// What the sample was numbered before.
    Index original(Index sample) const { return tree_.original(sample); }
    bool trusts(Index sample) const { return trusted_[static_cast<std::size_t>(sample)] != 0; }
    void trust(Index sample, bool yes) { trusted_[static_cast<std::size_t>(sample)] = yes ? 1 : 0; }

    /// What distances are taken by from now on; as the places are at first.
    void measure_by(const Metric& metric) { metric_ = metric; }

    /// The nearest trusted samples but itself, as PlaceTree::nearest has them.
    void nearest(Index sample, Index count, Neighbours& found) const;

    /// How far a sample is from where its nearest trusted ones have it by a polynomial of second
    /// degree, three to each of its terms, or of the first where there are fewer; does not exist
    /// where they say nothing of it. `off`, if given, becomes the way from the sample to there.
    Prediction predict(Index sample, Neighbours& found, std::span<double> off = {}) const;

    /// So many neighbours make a process.
    Index process_size() const { return 24 * std::max<Index>(2, axes()); }
    /// Through these neighbours of a sample.
    LocalProcess process(Index sample, const Neighbours& neighbours) const;

  private:
    template <int axes>
    Prediction by_polynomial(Index sample, Neighbours& found, std::span<double> off) const;

    PlaceTree tree_;
    PointSet points_;
    std::vector<char> trusted_;
    Metric metric_{1, 1, 1};
};

} // namespace batten
