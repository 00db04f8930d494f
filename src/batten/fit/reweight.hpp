#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// What all weights are divided by before anything is made of them, so that their size counts
/// nowhere: the weight that all have, else the power of two below the largest; 1 where there are
/// none. CLSPIA starts from multipliers of one [ChangMaDeng2023, section 3.2], so for it the size
/// of uneven weights counts unless it is beyond 2^-200 to 2^200.
double usual_weight(const std::vector<double>& weights, std::string_view method);

/// The same samples and options for weights that are divided by `unit`.
Samples reweighted(Samples samples, double unit);
FitOptions reweighted(FitOptions options, double unit);

/// A result for such weights, for the caller's again: gradients and steps, sums over the weights.
FitResult reweighted(FitResult result, double unit);

} // namespace batten
