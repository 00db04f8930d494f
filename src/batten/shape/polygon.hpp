#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Twice the signed area of the triangle a b c in the plane: positive for a turn to the left at b.
double turn(std::span<const double> a, std::span<const double> b, std::span<const double> c);

/// In units of what rounding the coordinates changes: what a turn must be to be certain; to stay so
/// after a shift of them, as the turns of a shape that is kept; and to be none that the roundings
/// of an iteration add up to.
inline constexpr double certain_roundings = 2;
inline constexpr double kept_roundings = 16;
inline constexpr double distinct_roundings = 1e6;

/// Sign (-1, 1) of the turn at b, or 0 where it is within so many times what rounding the
/// coordinates changes.
int turn_sign(std::span<const double> a, std::span<const double> b, std::span<const double> c,
              double roundings = certain_roundings);

/// Signs (-1, 1, or 0 where rounding of the coordinates leaves none) of the turns of a planar
/// polygon, after consecutive equal points are taken as one: the directional angles of
/// [LinWangDong2004, section 1.3]. Closed: the turns over the seam count.
std::vector<int> turn_signs(const PointSet& polygon, Closure closure = Closure::open,
                            double roundings = certain_roundings);

/// Changes of the turns' sign along a planar polygon, straight places left out.
Index inflection_count(const PointSet& polygon, Closure closure = Closure::open,
                       double roundings = certain_roundings);

/// Sum of the sizes of a planar polygon's turns, in radians: what a curve with this control polygon
/// turns at most.
double total_turning(const PointSet& polygon, Closure closure = Closure::open);

/// Whether a polygon whose points have moved still has its shape: turns of more than so many
/// roundings have their signs, what was straight is so or bends by more than `bend` roundings, and
/// there are no more inflections than before.
bool keeps_shape(const PointSet& polygon, const PointSet& moved, Closure closure, double roundings,
                 double bend);

} // namespace batten
