#pragma once

#include <batten/problem/subset.hpp>
#include <batten/search/curve_trial.hpp>

#include <vector>

namespace batten {

/// Samples that stand for all of a task's, ascending: one in each of `stretches` equal parts of the
/// sequence and one in each of as many equal parts of its parameters, so that neither crowds nor
/// far stretches are missed; the ends; and what something is said of, with its neighbours.
std::vector<Index> representatives(const CurveTask& task, Index stretches);

/// A task for some of another's samples, with all that is said of each. It refers to the other.
class ThinnedTask {
  public:
    /// `kept`: ascending indices of samples, those among them that something is said of.
    ThinnedTask(const CurveTask& whole, const std::vector<Index>& kept);
    ThinnedTask(const ThinnedTask&) = delete;
    ThinnedTask& operator=(const ThinnedTask&) = delete;

    CurveTask& task() { return task_; }
    const std::vector<Index>& kept() const { return subset_.kept(); }
    Index original(Index sample) const { return subset_.original(sample); }
    std::vector<Index> original(std::vector<Index> samples) const;

    /// A trial of some as one of all samples: those between two of some start between their
    /// parameters and are corrected; `ratio` is that of each sample's closest point nearby, `worst`
    /// the largest of all.
    CurveTrial carried(const CurveTrial& trial) const;
    /// The other way: knots and control points with these samples' parameters and distances, and
    /// the weights that `before` had, of others the greater of their neighbours' there.
    CurveTrial restricted(const CurveTrial& all, const ThinnedTask& other,
                          const std::vector<double>& before) const;

  private:
    std::vector<Index> placed(const std::vector<Index>& samples) const;

    const CurveTask& whole_;
    Subset subset_;
    Samples samples_;
    CurveTask task_;
};

/// Adds to some samples, ascending, and to `offenders` what nearly breaks the tolerance between two
/// of them: the worst of each such stretch, and others spread over it where it is so bad that its
/// shape was not seen. Returns whether there were any.
bool add_offenders(const CurveTrial& all, std::vector<Index>& kept, std::vector<Index>& offenders);

} // namespace batten
