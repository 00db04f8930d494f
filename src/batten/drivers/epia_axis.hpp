#pragma once

#include <batten/basis/place_knots.hpp>
#include <batten/system/sample_groups.hpp>

#include <vector>

namespace batten {

/// One axis of an EPIA fit: which samples are control points' own, and by the fence between them
/// which samples belong to which group.
class EpiaAxis {
  public:
    /// `controls`: ascending indices, the first and last sample among them; more are added evenly
    /// up to degree + 1. `alone`: samples whose group holds just themselves; they become control
    /// points' own.
    EpiaAxis(int degree, std::vector<double> parameters, std::vector<double> curvature,
             std::vector<Index> controls, std::vector<Index> alone);

    const std::vector<Index>& controls() const { return controls_; }
    bool has(Index sample) const;
    /// Makes a sample a control point's own; the fence around it follows.
    void insert(Index sample);
    double parameter(Index sample) const { return parameters_[static_cast<std::size_t>(sample)]; }
    /// Samples of each group, by the minimum difference rule [LinZhang2011, eq. 44].
    std::vector<SampleRange> groups() const;
    /// Knots by averaging [eq. 38, 41, 42].
    KnotVector knots() const;

  private:
    Index fence(Index before, Index after) const;
    bool is_alone(Index sample) const;

    int degree_;
    std::vector<double> parameters_;
    std::vector<double> curvature_;
    std::vector<Index> controls_;
    std::vector<Index> alone_;
};

} // namespace batten
