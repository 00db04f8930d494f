#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Incremental fitting by EPIA [LinZhang2011, Algorithm 1]: groups of samples move the control
/// points by their mean residual; when the moves are short or the error grows, the worst sample's
/// parameter becomes a control point's and a knot, and the iteration goes on from the refined
/// spline. Sequences, grids of 2 axes, and clouds with given parameters (epia_cloud.hpp).
///
/// Ends when every sample is within StopRule::deviation or its own tolerance (tolerance_met) or,
/// with as many control points as are stated, or as samples, by the gradient: no knot can come
/// then. A stated number is never exceeded, but by samples to be interpolated (and, with setting
/// screen = 0, by the dominant ones). Settings: eta, t_c, rounds, smoothing, exact, screen (see
/// methods()). Throws InvalidInput when there is nothing to stop at.
Fitted fit_epia(const Problem& problem, std::string_view method);

} // namespace batten
