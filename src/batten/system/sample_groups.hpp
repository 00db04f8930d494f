#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>
#include <batten/system/collocation.hpp>

#include <vector>

namespace batten {

/// A run of consecutive samples along an axis, [begin, end).
struct SampleRange {
    Index begin;
    Index end;
};

/// A sample in a control point's group.
struct GroupMember {
    Index control;
    Index sample;
};

/// Which samples' residuals move which control point: W of PIA (the control point's own sample) and
/// of EPIA (the mean over the control point's group [LinZhang2011, eq. 9 and 22]).
class SampleGroups {
  public:
    /// A sequence or grid: per axis and control point a run of samples; a grid's groups are
    /// products of runs. `weights`: one per sample, positive, or none for ones. Throws InvalidInput
    /// naming a control point whose run is empty or beyond the samples.
    SampleGroups(std::vector<std::vector<SampleRange>> ranges, const std::vector<Index>& shape,
                 std::vector<double> weights = {});
    /// A cloud: the members of all groups; a control point without any does not move.
    SampleGroups(std::vector<GroupMember> members, Index controls,
                 std::vector<double> weights = {});

    /// Control points N.
    Index size() const { return static_cast<Index>(total_.size()); }
    /// 1 without weights.
    double weight(Index sample) const {
        return weights_.empty() ? 1 : weights_[static_cast<std::size_t>(sample)];
    }
    /// Weighted means over the groups of per-sample values (m x dim): (N x dim).
    PointSet means(const PointSet& values) const;
    /// Calls `member(control, sample)` for every member of every group.
    template <class Member>
    void for_each_member(Member member) const;

  private:
    void count(Index controls);

    std::vector<std::vector<SampleRange>> ranges_;
    std::vector<Index> shape_;
    std::vector<GroupMember> members_; ///< of a cloud
    std::vector<double> weights_;
    std::vector<double> total_; ///< weight per group
};

/// The residual Q - A P of every sample and its image W(Q - A P): the data-side form of a geometric
/// iteration.
class DataSide {
  public:
    DataSide(std::vector<KnotVector> axes, const Samples& samples, const Parameters& parameters,
             SampleGroups groups);

    /// A P for free control points P (N x dim) of any dim: (m x dim).
    PointSet values(const PointSet& control) const;
    /// Q - A P: (m x dim).
    PointSet residual(const PointSet& control) const;
    const SampleGroups& groups() const { return groups_; }
    const std::vector<KnotVector>& axes() const { return axes_; }
    Index dim() const { return samples_.dim(); }
    Index sample_count() const { return samples_.size(); }

  private:
    std::vector<KnotVector> axes_;
    const Samples& samples_;
    const Parameters& parameters_;
    std::vector<Collocation> collocations_;
    SampleGroups groups_;
};

template <class Member>
void SampleGroups::for_each_member(Member member) const {
    for (const GroupMember& one : members_) member(one.control, one.sample);
    if (ranges_.empty()) return;
    const auto visit = [&](auto&& self, std::size_t axis, Index control, Index sample) -> void {
        if (axis == ranges_.size()) return member(control, sample);
        const auto n = static_cast<Index>(ranges_[axis].size());
        for (Index i = 0; i < n; ++i) {
            const SampleRange range = ranges_[axis][static_cast<std::size_t>(i)];
            for (Index j = range.begin; j < range.end; ++j)
                self(self, axis + 1, control * n + i, sample * shape_[axis] + j);
        }
    };
    visit(visit, 0, 0, 0);
}

} // namespace batten
