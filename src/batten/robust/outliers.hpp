#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Samples that lie far from a robust fit to all (robust_fit.hpp): beyond six times the residuals'
/// scale, beyond five times what their neighbours are, and beyond the tolerance (or 1e-4 of the
/// data's size where none is stated). Samples with something to hold never do. Ascending.
std::vector<Index> find_outliers(const Samples& samples, const FitOptions& options);

/// A fit to the samples without some: of a grid these are replaced by the robust fit's values.
struct WithoutOutliers {
    Samples samples;
    FitOptions options;
    std::vector<Index> kept; ///< of a sequence or cloud the original indices; of a grid all
};

WithoutOutliers without_outliers(const Samples& samples, const FitOptions& options,
                                 const std::vector<Index>& outliers);

/// Enters the set-aside samples in the result: parameters for all samples, indices as the caller
/// knows them.
void account_for(const Samples& samples, const FitOptions& options, const WithoutOutliers& rest,
                 const std::vector<Index>& outliers, FitResult& result);

} // namespace batten
