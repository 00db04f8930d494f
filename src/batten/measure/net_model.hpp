#pragma once

#include <batten/measure/bezier_net.hpp>

namespace batten {

/// Half the squared distance of a net's point from the origin, to second order in its place.
struct NetModel {
    double square = 0; ///< the whole squared distance
    PerAxis<double> gradient{};
    AxisMatrix hessian{};      ///< on and below the diagonal
    AxisMatrix without_bend{}; ///< the Hessian without second derivatives of the net
};

/// The model at a place of the net, 0 to 1 along each axis.
NetModel model_at(const BezierNet& net, Index axis_count, Index dim, const PerAxis<double>& at);

} // namespace batten
