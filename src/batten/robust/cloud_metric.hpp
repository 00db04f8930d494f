#pragma once

#include <batten/robust/trusted_cloud.hpp>

namespace batten {

/// The samples over their parameters (m x 1 to 3) by a metric by which they predict each other
/// best: powers of two of the parameters' ranges, as near to these themselves as it goes.
TrustedCloud cloud_by_best_metric(const Points& points, const Points& places);

} // namespace batten
