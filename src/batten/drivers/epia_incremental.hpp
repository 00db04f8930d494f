#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The method's own numbers.
struct EpiaSettings {
    double eta;
    double t_c;
    Index rounds;
    Index smoothing;
    bool exact;
};

/// Incremental fitting [LinZhang2011, Algorithm 1] of a sequence or a grid of 2 axes whose
/// consecutive samples are distinct.
Fitted fit_incrementally(const Problem& problem, const EpiaSettings& settings);

} // namespace batten
