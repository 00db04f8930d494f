#pragma once

#include <batten/problem/problem.hpp>

namespace batten {

/// The samples that were set aside, ascending, and the problem without them: of a grid they become
/// the robust fit's values, of any tolerance.
struct WithoutOutliers {
    Problem rest;
    std::vector<Index> outliers;
};

/// Sets samples aside that lie far from a robust fit to all (robust_fit.hpp): beyond six times the
/// residuals' scale, beyond five times what their neighbours are, and beyond the tolerance (or 1e-4
/// of the data's size where none is stated). Samples with something to hold never do.
WithoutOutliers without_outliers(const Problem& problem);

} // namespace batten
