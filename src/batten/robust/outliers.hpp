#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// The samples that were set aside, ascending, and the problem without them: of a grid they become
/// the robust fit's values, of any tolerance.
struct WithoutOutliers {
    Problem rest;
    std::vector<Index> outliers;
};

/// Sets samples aside that are off beyond the tolerance (or 1e-4 of the data's size where none is
/// stated) and: of a curve, that disagree with their neighbours (sequence_outliers.hpp); of a
/// cloud, that are far from a robust fit to all (robust_fit.hpp), beyond six times the residuals'
/// scale and five times what most around them are; of a grid, that disagree along all axes, or
/// along one and are far from the robust fit. Samples with something to hold never are.
WithoutOutliers without_outliers(const Problem& problem);

} // namespace batten
