#pragma once

#include <batten/search/curve_refining.hpp>

namespace batten {

/// Knots for as many free control points as the task has different parameters: their means, of each
/// piece between lasting knots, and next to a seam one for each derivative that agrees there; on a
/// smooth closed curve at or between them.
KnotVector knots_through(const CurveTask& task);

/// The curve through every sample, on as many control points as there are different ones, thinned
/// out within the tolerances: the last resort of a search. `met` says that it is within them and
/// tame enough to be handed out. Tangents and a kept shape may keep it from that.
CurveWithin curve_through(const CurveTask& task);

} // namespace batten
