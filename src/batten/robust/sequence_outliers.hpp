#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Sequences of fewer different samples have no outliers.
inline constexpr Index fewest_in_sequence = 10;

/// Samples of a sequence (m x dim) that disagree with their neighbours (neighbour_outliers.hpp),
/// ascending; repeated samples count once. `least`: one per sample, infinite for one that stays;
/// `along`: the samples' ascending places, or empty for chord lengths.
///
/// Of a sequence and its reverse, in any unit, place and rotation, the same samples are found.
std::vector<Index> sequence_outliers(const Points& sequence, Closure closure,
                                     const std::vector<double>& least,
                                     const std::vector<double>& along = {});

} // namespace batten
