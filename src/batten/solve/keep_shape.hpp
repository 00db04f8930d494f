#pragma once

#include <batten/system/constraints.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// Least-squares control points (relative to the system's centre) of a planar curve whose control
/// polygon has at most `most_inflections`, under constraints with lengths given.
///
/// Each turn of the polygon gets the sign that changes the unlimited fit least; then quadratic
/// programs with the turns linearised around the present polygon follow each other until all have
/// their sign. Returns the last polygon, whether or not it came that far. Throws SolverError and
/// InvalidInput as solve_direct does.
PointSet solve_with_inflections(const NormalSystem& system, const Constraints& constraints,
                                Index most_inflections);

} // namespace batten
