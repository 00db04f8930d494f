#pragma once

#include <batten/system/normal_system.hpp>

namespace batten {

/// Least-squares control points (N x dim) relative to the system's centre, by banded Cholesky, axis
/// by axis. Throws SolverError when the samples do not determine every control point.
PointSet solve_direct(const NormalSystem& system);

} // namespace batten
