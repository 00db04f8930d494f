#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Samples of a cloud (m x dim) over parameters (m x 1 to 3) that disagree with their nearest
/// neighbours, ascending: what the most certain local polynomial without the sample predicts is
/// further away than five to six standard deviations of noise, than four times what the same
/// polynomial is off beside it, and than `least` (one per sample, infinite for one that stays).
///
/// The farthest are left out first and the others judged anew without them; at last what the rest
/// explains comes back, and what its neighbours are as badly predicted without stays, and so
/// do many together.
std::vector<Index> cloud_outliers(const Points& points, const Points& places,
                                  const std::vector<double>& least);

} // namespace batten
