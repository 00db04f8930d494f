#pragma once

#include <batten/robust/neighbours.hpp>

#include <vector>

namespace batten {

/// Samples of a cloud (m x dim) over parameters (m x 1 to 3) that disagree with their nearest
/// neighbours, ascending: by the likeliest Gaussian process through these they are further off than
/// six standard deviations, than 2.5 times what it is off at any of these, and than `least` (one
/// per sample, infinite for one that stays).
///
/// The farthest are left out first and the others judged anew without them; at last what the rest
/// explains comes back, the most certain first. Many together stay.
NeighbourOutliers cloud_outliers(const Points& points, const Points& places,
                                 const std::vector<double>& least);

} // namespace batten
