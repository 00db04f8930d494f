#pragma once

#include <batten/drivers/epia_start.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Incremental fitting [LinZhang2011, Algorithm 1] of a sequence or a grid of 2 axes whose
/// consecutive samples are distinct.
Fitted fit_incrementally(const Problem& problem, const EpiaSettings& settings);

} // namespace batten
