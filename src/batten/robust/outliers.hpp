#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// The samples that were set aside, ascending, and the problem without them: of a grid they become
/// what their neighbours predict, of any tolerance.
struct WithoutOutliers {
    Problem rest;
    std::vector<Index> outliers;
};

/// Sets samples aside that are off beyond the tolerance (or 1e-4 of the data's size where none is
/// stated) and: of a curve or grid, that disagree with their neighbours (neighbour_outliers.hpp);
/// of a cloud, that are far from a robust fit to all (robust_fit.hpp), beyond six times the
/// residuals' scale and five times what most around them are. Samples with something to hold never
/// are.
WithoutOutliers without_outliers(const Problem& problem);

} // namespace batten
