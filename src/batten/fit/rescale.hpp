#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The same samples and options in a unit in which lengths are `factor` times as large: only
/// exponents change, no digit.
Samples rescaled(Samples samples, double factor);
FitOptions rescaled(FitOptions options, double factor);

/// A result in such a unit, in the caller's again.
FitResult rescaled(FitResult result, double factor);

} // namespace batten
