#pragma once

#include <batten/drivers/epia_start.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// EPIA of a cloud with parameters [LinZhang2011, section 6]: every sample in the group of its
/// nearest control point. Of a stated size the knots are fixed; else the fit starts from degree + 1
/// control points along every axis and grows as Algorithm 1 does, the worst sample's parameters
/// becoming knots. A control point without samples stays where it is.
Fitted fit_cloud_incrementally(const Problem& problem, const EpiaSettings& settings);

} // namespace batten
