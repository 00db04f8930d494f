#pragma once

#include <batten/drivers/curve_passes.hpp>
#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The whole account of a fit: what the driver said of how it went, and what every fit's account
/// says of the samples, the spline, the deviations and the stated goals, measured here on the
/// spline itself.
FitResult accounted(Fitted fitted, const Problem& problem);

/// The same of a fit in passes, which measured it on the way; `notes` of the samples.
FitResult accounted(Passed passed, const std::vector<std::string>& notes,
                    const FitOptions& options);

} // namespace batten
