#pragma once

#include <batten/shape/polygon.hpp>

namespace batten {

/// Shortens all moves by one factor until the moved polygon turns the same way everywhere as the
/// present one: Algorithm 1 of [LinWangDong2004], whose line 3 means L' where it prints L.
/// `threshold` is its D as a part of the longest move. Where the polygon is straight it may begin
/// to bend, unless it gets inflections by that. The factors' sum may stay finite, which their
/// Theorem 2 excludes silently: the iteration can lock.
void keep_turns(const PointSet& polygon, PointSet& moves, Closure closure = Closure::open,
                double threshold = 1e-3);

/// What a control point may not cross: the whole lines through its neighbours, or the rays that the
/// paper prints.
enum class Barrier { lines, rays };

/// Shortens the moves one by one, in order, so that no control point crosses a line through its
/// neighbours, and so no turn of the polygon changes sign [ChangMaDeng2023, section 4.4]; `alpha`
/// in (0, 1) is the part of the way to such a line that is allowed. Where the polygon is straight
/// it may begin to bend, unless it gets inflections by that. With rays a control point far outside
/// may still slip past.
void keep_inflections(const PointSet& polygon, PointSet& moves, Closure closure = Closure::open,
                      double alpha = 0.8, Barrier barrier = Barrier::lines);

} // namespace batten
