#pragma once

#include <batten/core/core.hpp>

namespace batten {

/// Inflections of a planar polyline that are larger than `height`: between two inflections the line
/// bends one way, and such a stretch counts when some point of it is at least `height` from the
/// chord of its ends. Stretches below are flattened, the smallest first, so that their neighbours
/// become one.
Index visible_inflections(const Points& polyline, double height, Closure closure);

} // namespace batten
