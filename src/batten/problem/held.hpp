#pragma once

#include <batten/problem/problem.hpp>
#include <batten/system/constraints.hpp>

namespace batten {

/// Part of the data's size by which something may miss what must hold exactly and count as held.
inline constexpr double exactness = 1e-9;

/// Throws InvalidInput, naming the entry, when what must hold does not fit the samples: indices out
/// of range or given twice, tangents of another dimension, of no length or against the order of
/// the samples, boundaries of an axis that is closed or does not exist, of another degree or
/// dimension.
void check_held(const HoldOptions& hold, const Samples& samples, SampleKind kind,
                const AxisPlan& axes);

/// The equalities on the free control points over given knots. The boundaries' knots must be in
/// them (knots_for_boundaries).
Constraints held_constraints(const std::vector<KnotVector>& axes, const Samples& samples,
                             const Parameters& parameters, const HoldOptions& hold);

/// Parameters of a grid whose boundaries are given: along each axis those of its boundary samples'
/// closest points on the boundaries, averaged over these.
Parameters parameters_for_boundaries(const Samples& samples, Parameters parameters,
                                     const std::vector<HeldBoundary>& boundaries);

/// The axis's knots with those of the boundaries in place of the nearest others.
KnotVector knots_for_boundaries(const KnotVector& knots, int axis,
                                const std::vector<HeldBoundary>& boundaries);

/// Largest distance between the spline's boundaries and those that must hold.
double boundary_error(const Spline& spline, const std::vector<HeldBoundary>& boundaries);

/// By how much the held tangents are missed at most, as a part of the data's size: the derivative's
/// part across the direction, or its difference from the value; infinite for one turned round.
double tangent_error(const Spline& spline, const Samples& samples, const Parameters& parameters,
                     const std::vector<HeldTangent>& tangents);

} // namespace batten
