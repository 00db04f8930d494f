#pragma once

#include <batten/search/grid_sizes.hpp>

#include <vector>

namespace batten {

/// Some of the samples of a surface's or volume's task, with all that is said of each: of a grid
/// those where some of its lines cross, so that they are a grid, too; of a cloud those nearest to
/// the middles of even cells of its parameters. It refers to the task, of which nothing must hold
/// exactly.
class ThinnedGrid {
  public:
    /// About so many samples.
    ThinnedGrid(const GridTask& whole, Index wanted);
    ThinnedGrid(const ThinnedGrid&) = delete;
    ThinnedGrid& operator=(const ThinnedGrid&) = delete;

    /// The task of these samples: it refers to this object. Its `most` is what they can tell of.
    GridTask task() const;
    Index size() const { return samples_.size(); }
    /// Whether these samples tell of as many control points as the whole task may have.
    bool tells_all() const { return most_ == whole_.most; }

    /// Adds what nearly breaks the tolerance, by each sample's distance over it: of a grid the
    /// worst line of those between two that are here, of a cloud the worst samples. Returns
    /// whether there were any.
    bool add_offenders(const std::vector<double>& ratio);

  private:
    void pick_lines(Index wanted);
    void pick_from_cells(Index wanted);
    bool add_lines(const std::vector<double>& ratio);
    bool add_samples(const std::vector<double>& ratio);
    void keep_crossings();
    /// Fills what follows from the samples that are kept.
    void take();

    const GridTask& whole_;
    std::vector<std::vector<Index>> lines_; ///< of a grid: ascending, per axis
    std::vector<Spread> bends_;             ///< of all samples of a grid, per axis
    std::vector<Index> kept_;               ///< ascending
    std::vector<Index> most_;
    Samples samples_;
    Parameters parameters_;
    std::vector<double> tolerance_;
};

} // namespace batten
