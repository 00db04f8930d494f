#pragma once

#include <batten/problem/options.hpp>
#include <batten/system/sample_groups.hpp>

namespace batten {

/// Which control point each of a cloud's samples belongs to: that whose Greville abscissae are
/// nearest. A sample of `alone` has its control point to itself; the others' samples go to the
/// nearest of its neighbours, or, where none is left, nowhere (-1). Throws InvalidInput where two
/// of `alone` find no control points of their own.
std::vector<Index> nearest_controls(const Parameters& parameters,
                                    const std::vector<KnotVector>& axes,
                                    const std::vector<Index>& alone);

/// Free control points (N x dim) to start from.
PointSet initial_control(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, const MethodOptions& options);

/// The moves (N x dim) that led to the given start, over these axes. Throws InvalidInput as
/// initial_control does.
PointSet moves_before(Index dim, const std::vector<KnotVector>& axes, const MethodOptions& options);

} // namespace batten
