#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/subset.hpp>

namespace batten {

/// Samples that lie far from a robust fit to all (robust_fit.hpp): beyond six times the residuals'
/// scale, beyond five times what their neighbours are, and beyond the tolerance (or 1e-4 of the
/// data's size where none is stated). Samples with something to hold never do. Ascending.
std::vector<Index> find_outliers(const Problem& problem);

/// The problem without some samples: of a grid these become the robust fit's values, of any
/// tolerance.
Problem without_outliers(const Problem& problem, const std::vector<Index>& outliers);

} // namespace batten
