#pragma once

#include <batten/basis/knot_vector.hpp>

namespace batten {

/// The knot vectors that keep every k-th breakpoint, with its multiplicity, for each k that divides
/// the number of spans: fewest control points first, the given knots last.
std::vector<KnotVector> nested_knots(const KnotVector& knots);

} // namespace batten
