#pragma once

#include <batten/robust/trusted_cloud.hpp>

#include <vector>

namespace batten {

/// Samples of a cloud that are far off among their neighbours, the farthest first and the others
/// judged anew without them: more than outliers. They are not trusted any more. `least`: what each
/// may be off, by original number.
std::vector<Index> leave_out_suspects(TrustedCloud& cloud, const std::vector<double>& least);

} // namespace batten
