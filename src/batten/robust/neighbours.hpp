#pragma once

#include <batten/core/core.hpp>

#include <limits>
#include <span>
#include <vector>

namespace batten {

/// Neighbours that tell where a sample of a sequence should be: so many before it, so many behind
/// it, at most 8, and the degree of their least-squares polynomial over the chords between them.
struct Stencil {
    Index before;
    Index behind;
    int degree;

    bool one_sided() const { return before == 0 || behind == 0; }
};

/// How far a sample is from where a stencil's neighbours have it.
struct Prediction {
    /// Infinite where the sequence ends too soon.
    double residual = std::numeric_limits<double>::infinity();
    /// The next orthogonal polynomial over the neighbours, at the sample: what the residual of a
    /// smooth curve grows with, of an interpolant the product of the distances along the curve
    /// [Forsythe1957].
    double reach = 0;

    bool exists() const { return residual < std::numeric_limits<double>::infinity(); }
};

/// Places among the trusted samples: the last before a sample and the first behind it, perhaps
/// beyond an end.
struct Gap {
    Index before;
    Index behind;
};

/// Samples of a sequence that are trusted, and what they say of each other and of the rest. The
/// same from either end: nothing is counted along the sequence.
class Trusted {
  public:
    /// Of a sequence without repetitions; the k-th neighbour is k times `stride` samples away, the
    /// mean of those up to half a stride from there.
    Trusted(Points sequence, Closure closure, Index stride);

    /// Takes the samples that are not `left_out`.
    void take(const std::vector<bool>& left_out);

    /// Median distance of neighbours a stride apart.
    double usual_step() const;

    Index size() const { return static_cast<Index>(members_.size()); }
    Index stride() const { return stride_; }
    const Points& sequence() const { return sequence_; }
    const std::vector<Index>& members() const { return members_; }
    /// The places about a sample, trusted or not, that its neighbours are counted from.
    Gap gap(Index sample) const;
    /// A place that may be beyond an end: wrapped where closed, else -1.
    Index within(Index place) const;
    /// The trusted samples 0, 1, ... `count` - 1 strides away from a gap on the sides asked for.
    std::vector<Index> around(const Gap& gap, Index count, bool before, bool behind) const;

    /// Of a sample, by trusted ones beside it.
    Prediction predict(Index sample, const Gap& gap, const Stencil& stencil) const;
    Prediction predict(Index sample, const Stencil& stencil) const {
        return predict(sample, gap(sample), stencil);
    }
    /// The least residual by any of the stencils.
    double least_residual(Index sample, std::span<const Stencil> stencils) const;

  private:
    bool neighbour(Index place, std::span<double> point) const;

    Points sequence_;
    Closure closure_;
    Index stride_;
    std::vector<Index> members_;
    PointSet sums_; ///< of the members before a place, from the first sample on; of strides only
};

} // namespace batten
