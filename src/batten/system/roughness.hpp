#pragma once

#include <batten/basis/active_functions.hpp>
#include <batten/core/function_ref.hpp>
#include <batten/core/points.hpp>
#include <batten/system/banded_matrix.hpp>

namespace batten {

/// The integrals over the domain of products of the B-splines' derivatives of the given order (0:
/// of the B-splines themselves), exact: P^T M P is the integral of |C^(order)|^2 of a curve.
BandedMatrix roughness_matrix(const KnotVector& knots, int order);

/// The same for the axis stretched to [0, 1]: with the domain's length to the power of twice the
/// order less one.
BandedMatrix unit_roughness_matrix(const KnotVector& knots, int order);

/// That power.
double unit_roughness_scale(const KnotVector& knots, int order);

/// Calls `visit` for `nodes` Gauss-Legendre nodes of each span with the node's weight and the
/// B-splines' derivatives of the given order there: the sum of weight b b^T is the first
/// matrix from degree - order + 1 nodes on.
void for_each_roughness_row(
    const KnotVector& knots, int order, int nodes,
    FunctionRef<void(double weight, const ActiveFunctions& derivatives)> visit);

/// Whether places (m x 1 to 3) determine what has no roughness: polynomials of lower degree than
/// the order along every axis. Else no factor of the sum of the axes' roughness makes a fit unique.
bool determine_smoothest(const Points& places, int order);

} // namespace batten
