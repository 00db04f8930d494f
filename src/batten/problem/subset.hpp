#pragma once

#include <batten/problem/problem.hpp>

#include <vector>

namespace batten {

/// Some of a problem's samples, in order, with all that is said of each: what is left without
/// outliers, repetitions, a seam, or samples that are held exactly.
class Subset {
  public:
    /// All of `count` samples but the ascending `left_out`.
    static Subset without(const std::vector<Index>& left_out, Index count);
    /// The ascending `kept` of `count` samples.
    static Subset keeping(std::vector<Index> kept, Index count);

    Index size() const { return static_cast<Index>(kept_.size()); }
    bool whole() const { return size() == count_; }
    /// Ascending indices of the samples that are left.
    const std::vector<Index>& kept() const { return kept_; }
    /// Index before of sample `i` of the subset.
    Index original(Index i) const { return kept_[static_cast<std::size_t>(i)]; }
    /// Place in the subset of the sample that was `i`, or of the next one after it that is left.
    Index place(Index i) const;

    /// Points and weights; a grid becomes a cloud.
    Samples of(const Samples& samples) const;
    /// A sequence's parameters stay a sequence's, a grid's become scattered.
    Parameters of(const Parameters& parameters) const;
    std::vector<double> of(const std::vector<double>& values) const;
    /// What is said of samples that are left, under their new indices.
    HoldOptions of(HoldOptions hold) const;
    FitOptions of(FitOptions options) const;
    /// The same problem of these samples; not of a grid.
    Problem of(const Problem& problem) const;

    /// Parameters of all samples from those of the subset: one left out gets a place between its
    /// neighbours'.
    std::vector<double> spread(const std::vector<double>& parameters) const;

  private:
    Subset(std::vector<Index> kept, Index count) : kept_(std::move(kept)), count_(count) {}

    std::vector<Index> kept_;
    Index count_;
};

} // namespace batten
