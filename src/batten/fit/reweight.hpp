#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// What all weights are divided by before anything is made of them, so that their size counts
/// nowhere: the weight that all have, else the power of two below the largest; 1 where there are
/// none. CLSPIA's multipliers start from one [ChangMaDeng2023, section 3.2]: where something is to
/// hold the size of uneven weights counts for it, between 2^-200 and 2^200.
double usual_weight(const std::vector<double>& weights, const FitOptions& options);

/// The same samples and options for weights that are divided by `unit`.
Samples reweighted(Samples samples, double unit);
FitOptions reweighted(FitOptions options, double unit);

/// A result for such weights, for the caller's again: gradients and steps, sums over the weights.
FitResult reweighted(FitResult result, double unit);

} // namespace batten
