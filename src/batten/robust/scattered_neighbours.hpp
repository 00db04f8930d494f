#pragma once

#include <batten/robust/neighbours.hpp>

namespace batten {

/// The nearest neighbours that tell where a sample of a cloud should be: their number in parts of
/// the terms of their least-squares polynomial over the parameters, and its degree.
struct Surroundings {
    int degree;
    Index times;
};

/// Samples of a cloud that are trusted, and what they say of each other and of the rest.
class TrustedCloud {
  public:
    /// All samples; places are (m x 1 to 3).
    TrustedCloud(Points points, Points places);

    const Points& points() const { return points_; }
    Index size() const { return points_.size(); }
    bool trusts(Index sample) const { return trusted_[static_cast<std::size_t>(sample)] != 0; }
    void trust(Index sample, bool yes) { trusted_[static_cast<std::size_t>(sample)] = yes ? 1 : 0; }

    /// The nearest trusted samples but itself, nearest first, and those that are as far as the
    /// last.
    std::vector<Index> nearest(Index sample, Index count) const;
    /// Of a sample, by its nearest trusted ones; `off`, if given, becomes the way from the sample
    /// to where they have it. The reach is what a Taylor polynomial's remainder grows with.
    Prediction predict(Index sample, const Surroundings& by, std::span<double> off = {}) const;

  private:
    std::array<Index, 3> cell(Index sample) const;

    Points points_;
    Points places_;
    std::vector<char> trusted_;
    GridIndex cells_;
    std::array<double, 3> low_{};
    double width_ = 1;         ///< of a cell
    std::vector<Index> first_; ///< of each cell's samples in `order_`
    std::vector<Index> order_;
};

} // namespace batten
