#pragma once

#include <batten/search/curve_closest.hpp>

namespace batten {

/// The task with so much roughness counted that what the samples show of it costs `part` of the
/// tolerance.
CurveTask calmer(CurveTask task, double part);

/// Sees curves on these knots with ever more roughness counted until one is acceptable, then, by
/// bisection, with as little as that takes.
void see_calmer(const CurveTask& task, const KnotVector& knots, ClosestSeen& closest);

} // namespace batten
