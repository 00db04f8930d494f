#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// The samples that were set aside, ascending, and the problem without them: of a grid they become
/// what their neighbours predict, of any tolerance.
struct WithoutOutliers {
    Problem rest;
    std::vector<Index> outliers;
};

/// Sets samples aside that are off beyond the tolerance (where none is stated 1e-9 of the data's
/// size, of a cloud 1e-4) and disagree with their neighbours: of a curve or grid along its axes
/// (neighbour_outliers.hpp), of a cloud around them (cloud_outliers.hpp). Samples with something to
/// hold never are.
WithoutOutliers without_outliers(const Problem& problem);

} // namespace batten
