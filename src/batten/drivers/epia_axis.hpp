#pragma once

#include <batten/basis/place_knots.hpp>
#include <batten/system/sample_groups.hpp>

#include <vector>

namespace batten {

/// One axis of an EPIA fit: which samples are control points' own, and by the fence between them
/// which samples belong to which group.
class EpiaAxis {
  public:
    /// What the samples along the axis are known by.
    struct Line {
        std::vector<double> parameters;
        std::vector<double> curvature; ///< [LinZhang2011, eq. 30, 32 and 33]
        double noise = 0;              ///< curvatures that differ by less are equal
    };

    /// `controls`: ascending indices, the first and last sample among them; more are added evenly
    /// up to `least`, at least degree + 1. `alone`: samples whose group holds just themselves; they
    /// become control points' own, and so does one between two of them that have others between.
    EpiaAxis(int degree, Line line, std::vector<Index> controls, std::vector<Index> alone,
             Index least = 0);

    const std::vector<Index>& controls() const { return controls_; }
    Index control_count() const { return static_cast<Index>(controls_.size()); }
    Index sample_count() const { return static_cast<Index>(line_.parameters.size()); }
    bool has(Index sample) const;
    /// The sample nearest by index that is no control point's own; the given one where all are.
    Index nearest_free(Index sample) const;
    /// Makes samples control points' own, in any order; the fence around them follows. Whether any
    /// was not one already.
    bool insert(std::vector<Index> samples);
    double parameter(Index sample) const {
        return line_.parameters[static_cast<std::size_t>(sample)];
    }
    /// Samples of each group, by the minimum difference rule [LinZhang2011, eq. 44].
    std::vector<SampleRange> groups() const;
    /// Knots by averaging [eq. 38, 41, 42].
    KnotVector knots() const;

  private:
    Index fence(Index before, Index after) const;
    bool is_alone(Index sample) const;

    int degree_;
    Line line_;
    std::vector<Index> controls_;
    std::vector<Index> alone_; // ascending
};

/// Knots of all axes.
std::vector<KnotVector> knots_of(const std::vector<EpiaAxis>& axes);

/// Samples per axis and group.
std::vector<std::vector<SampleRange>> groups_of(const std::vector<EpiaAxis>& axes);

/// Control points per axis.
std::vector<Index> shape_of(const std::vector<EpiaAxis>& axes);

/// P^0: the axes' own samples themselves, (N x dim) [eq. 31 and 36].
PointSet own_samples(const std::vector<EpiaAxis>& axes, const Samples& samples);

} // namespace batten
