#pragma once

#include <batten/search/curve_trial.hpp>

#include <vector>

namespace batten {

/// A sequence turned round, so that a search finds one curve for it whichever way it is given: an
/// open one's last sample comes first, a closed one's first sample stays.
class Turned {
  public:
    Turned(Index samples, Closure closure) : samples_(samples), closure_(closure) {}

    /// Where a sample goes, and where it comes from.
    Index operator()(Index sample) const;
    Samples operator()(const Samples& samples) const;
    std::vector<double> operator()(const std::vector<double>& values) const;
    HoldOptions operator()(HoldOptions hold) const;
    /// The same curve run the other way.
    CurveTrial operator()(const CurveTrial& trial) const;
    /// Ascending parameters over [begin, end].
    std::vector<double> parameters(const std::vector<double>& parameters, double begin,
                                   double end) const;

  private:
    Index samples_;
    Closure closure_;
};

/// Whether a search takes the sequence from its end: where it turns more in the first half of its
/// length than in the second, failing that has more samples there, or else from the greater of both
/// ends. Of a sequence and its reverse one runs backwards; neither unit nor place nor rotation
/// counts.
bool runs_backwards(const Points& sequence, Closure closure);

} // namespace batten
