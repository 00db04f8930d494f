#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Sequences of fewer different samples have no outliers.
inline constexpr Index fewest_in_sequence = 10;

/// Samples of a sequence (m x dim) that disagree with their neighbours on both sides, ascending:
/// what the neighbours predict is further away than six times the spread of such residuals, than
/// four times what they are beside it, and than `least` (one per sample, infinite for one that
/// stays).
///
/// A run of samples that follow each other smoothly stays, and so does a bend or a corner that its
/// neighbours do not know without it. Of a sequence and its reverse, in any unit, place and
/// rotation, the same samples are found.
std::vector<Index> sequence_outliers(const Points& sequence, Closure closure,
                                     const std::vector<double>& least);

} // namespace batten
