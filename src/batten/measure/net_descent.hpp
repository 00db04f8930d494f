#pragma once

#include <batten/measure/bezier_net.hpp>

namespace batten {

/// Where a descent on a net ended.
struct Descent {
    PerAxis<double> at{}; ///< 0 to 1 along each axis of the net
    double square = 0;    ///< squared distance from the origin there
    double gain = 0;      ///< what one more step of Newton's method would take off it
};

/// Newton's method for the net's point nearest to the origin, kept on the net: an axis at its end
/// moves only when that leads inside. Never ends farther away than it began; at most `steps` steps.
Descent descend(const BezierNet& net, Index axis_count, Index dim, const PerAxis<double>& start,
                int steps);

} // namespace batten
