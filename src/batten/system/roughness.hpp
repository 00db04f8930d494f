#pragma once

#include <batten/basis/basis_functions.hpp>
#include <batten/system/banded_matrix.hpp>

namespace batten {

/// The integrals over the domain of products of the B-splines' derivatives of the given order (0:
/// of the B-splines themselves), exact: P^T M P is the integral of |C^(order)|^2 of a curve.
BandedMatrix roughness_matrix(const KnotVector& knots, int order);

} // namespace batten
