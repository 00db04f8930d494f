#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Twice the signed area of the triangle a b c in the plane: positive for a turn to the left at b.
double turn(std::span<const double> a, std::span<const double> b, std::span<const double> c);

/// Sign (-1, 1) of the turn at b, or 0 where it is within so many times what rounding the
/// coordinates changes.
int turn_sign(std::span<const double> a, std::span<const double> b, std::span<const double> c,
              double roundings = 2);

/// Signs (-1, 1, or 0 where rounding of the coordinates leaves none) of the turns of a planar
/// polygon, after consecutive equal points are taken as one: the directional angles of
/// [LinWangDong2004, section 1.3]. Closed: the turns over the seam count.
std::vector<int> turn_signs(const PointSet& polygon, Closure closure = Closure::open);

/// Changes of the turns' sign along a planar polygon, straight places left out.
Index inflection_count(const PointSet& polygon, Closure closure = Closure::open);

} // namespace batten
