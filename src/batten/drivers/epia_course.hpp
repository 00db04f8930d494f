#pragma once

#include <batten/iterate/pia.hpp>
#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

#include <limits>
#include <vector>

namespace batten {

/// EPIA between two insertions, and the account of all of them: one entry per iteration, whatever
/// is inserted between.
class EpiaCourse {
  public:
    /// `t_c`: the longest mean residual below which an insertion is due.
    EpiaCourse(const Problem& problem, double t_c);

    /// How a run ended.
    struct Run {
        PointSet control;
        PointSet residual; ///< Q - A P there
        bool insert;       ///< a knot is due
    };

    /// Iterates until a knot is due or the fit ends. `full`: none can come, so that gradients end
    /// the fit, too.
    Run run(const DataSide& data, PointSet start, bool full);

    /// How far a residual is for its sample's precision, in parts of the tightest one; its length
    /// where all are alike.
    double far(const PointSet& residual, Index sample) const;

    /// The account of the whole, with the rate of the last control points' iteration.
    FitReport report(const DataSide& last, PointSet control);

  private:
    struct Entry {
        double gradient_norm;
        double largest_mean; ///< e_c [eq. 26]
        Index controls;
    };

    double farthest(const PointSet& residual) const;
    void enter(FitReport run);

    const Problem& problem_;
    double t_c_;
    double tightest_ = 0; ///< precision of a sample, where they have their own
    FitReport report_;
    std::vector<Entry> entries_;
    Index runs_ = 0;
    Index left_; ///< iterations that are allowed still
    double last_error_ = std::numeric_limits<double>::infinity();
};

} // namespace batten
