#pragma once

#include <batten/core/core.hpp>

#include <array>
#include <limits>
#include <span>
#include <vector>

namespace batten {

/// Neighbours that tell where a sample of a sequence should be: so many before it, so many behind
/// it, the degree of their least-squares polynomial along the sequence, and how many that are still
/// nearer are not asked.
struct Stencil {
    Index before;
    Index behind;
    int degree;
    Index skipped = 0;

    bool one_sided() const { return before == 0 || behind == 0; }
};

/// How far a sample is from where a stencil's neighbours have it.
struct Prediction {
    /// Infinite where the sequence ends too soon.
    double residual = std::numeric_limits<double>::infinity();
    /// Standard deviation of the residual in parts of that of white noise.
    double gain = 1;
    /// The next orthogonal polynomial over the neighbours, at the sample: what the residual of a
    /// smooth curve grows with, of an interpolant the product of the distances along the curve
    /// [Forsythe1957].
    double reach = 0;

    bool exists() const { return residual < std::numeric_limits<double>::infinity(); }
    /// In units of a sample's noise.
    double normal() const { return residual / gain; }
};

/// Samples of a sequence or grid that are trusted, and what they say of each other and of the rest,
/// along each axis. The same from either end: nothing is counted along the sequence.
class Trusted {
  public:
    static constexpr Index most_neighbours = 32;

    /// All samples. `along`, per axis: each sample's place along it, ascending and over one period
    /// where closed; empty: chord lengths between the neighbours that are asked.
    Trusted(Points points, GridIndex grid, std::vector<Closure> closures,
            std::vector<std::vector<double>> along);

    void place_along(std::size_t axis, std::vector<double> along);
    void take(Index sample) { trusted_[static_cast<std::size_t>(sample)] = 1; }
    void leave_out(const std::vector<Index>& samples);

    const Points& points() const { return points_; }
    const GridIndex& grid() const { return grid_; }
    Index size() const { return points_.size(); }
    std::size_t axis_count() const { return grid_.axis_count(); }
    Closure closure(std::size_t axis) const { return closures_[axis]; }
    bool by_chords(std::size_t axis) const { return along_[axis].empty(); }
    bool trusts(Index sample) const { return trusted_[static_cast<std::size_t>(sample)] != 0; }
    /// The sample so many steps away along an axis, -1 beyond an end.
    Index beside(Index sample, std::size_t axis, Index steps) const;
    /// The nearest trusted samples along an axis to one side, nearest first; fewer where it ends.
    /// `step`: 1 behind the sample, -1 before it.
    Index nearest(Index sample, std::size_t axis, Index step, std::span<Index> found) const;
    /// Whether one of the next `count` samples along any axis is trusted.
    bool within(Index sample, Index count) const;

    /// Of a sample, by trusted ones beside it along an axis; `off`, if given, becomes the way from
    /// the sample to where they have it.
    Prediction predict(Index sample, std::size_t axis, const Stencil& stencil,
                       std::span<double> off = {}) const;

  private:
    struct Line;
    bool line(Index sample, std::size_t axis, const Stencil& stencil, Line& line) const;
    void by_chords(Index sample, std::size_t axis, const Stencil& stencil, Line& line) const;
    Index position(Index sample, std::size_t axis) const {
        return sample / grid_.stride(axis) % grid_.length(axis);
    }

    Points points_;
    GridIndex grid_;
    std::vector<Closure> closures_;
    std::vector<std::vector<double>> along_;
    std::vector<char> trusted_;
};

/// Samples that were set aside, ascending, and where their neighbours have them.
struct NeighbourOutliers {
    std::vector<Index> samples;
    PointSet predicted;
};

} // namespace batten
