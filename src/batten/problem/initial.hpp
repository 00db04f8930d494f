#pragma once

#include <batten/problem/options.hpp>
#include <batten/system/sample_groups.hpp>

namespace batten {

/// Groups of a cloud's samples: each belongs to the control point whose Greville abscissae are
/// nearest. A sample of `alone` has its control point to itself; the others' samples go to the
/// nearest of its neighbours, or, where none is left, nowhere. Throws InvalidInput where two of
/// `alone` find no control points of their own.
std::vector<GroupMember> nearest_groups(const Parameters& parameters,
                                        const std::vector<KnotVector>& axes,
                                        const std::vector<Index>& alone = {});

/// Free control points (N x dim) to start from.
PointSet initial_control(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, const MethodOptions& options);

/// The moves (N x dim) that led to the given start, over these axes. Throws InvalidInput as
/// initial_control does.
PointSet moves_before(Index dim, const std::vector<KnotVector>& axes, const MethodOptions& options);

} // namespace batten
