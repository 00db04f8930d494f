#pragma once

#include <batten/parametrize/parametrize.hpp>

namespace batten {

/// The plane whose coordinates become a cloud's parameters.
enum class Projection {
    xy,
    xz,
    yz,
    plane, ///< through the points' mean, of least squared distances to them
};

/// The points' coordinates in the plane, (m x 2). Throws InvalidInput for points of less than 3
/// dimensions (xy: 2).
PointSet plane_coordinates(const Samples& samples, Projection projection);

/// Parameters of a cloud: its points' coordinates in the plane, each stretched to [0, 1]. Throws
/// InvalidInput for points of less than 3 dimensions (xy: 2), or of no extent along one of them.
Parameters projected(const Samples& samples, Projection projection);

} // namespace batten
