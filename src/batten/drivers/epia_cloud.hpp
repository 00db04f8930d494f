#pragma once

#include <batten/drivers/epia_start.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// EPIA of a cloud with parameters [LinZhang2011, section 6]: every sample in the group of its
/// nearest control point. Of a stated size the knots are fixed; else the fit starts from degree + 1
/// control points along every axis and grows as Algorithm 1 does: a knot halves the worst sample's
/// span along the axis where it is the wider part, as long as both halves hold as many samples as
/// control points across. A control point that no sample is nearest to stays where it is.
Fitted fit_cloud_incrementally(const Problem& problem, const EpiaSettings& settings);

} // namespace batten
