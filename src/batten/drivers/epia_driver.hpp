#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Incremental fitting by EPIA [LinZhang2011, Algorithm 1]: groups of samples move the control
/// points by their mean residual; when the moves are short or the error grows, the worst sample's
/// parameter becomes a control point's and a knot, and the iteration goes on from the refined
/// spline. Sequences, grids of 2 axes, and clouds with given parameters (groups by nearest control
/// point, no insertion).
///
/// Ends when every sample is within StopRule::deviation (tolerance_met) or, for a cloud or a stated
/// number of control points that is reached, by the gradient. Settings: eta, t_c, rounds,
/// smoothing, exact (see methods()). Throws InvalidInput when there is nothing to stop at.
Fitted fit_epia(const Problem& problem, std::string_view method);

} // namespace batten
