#pragma once

#include <batten/basis/knot_vector.hpp>

#include <array>

namespace batten {

/// Values of the degree + 1 B-splines that do not vanish on a span; entries beyond are not set.
using BasisValues = std::array<double, max_degree + 1>;

/// Values at t of the B-splines with indices span - degree to span [PieglTiller1997, algorithm
/// A2.2]. `span` is knots.span(t), or any span of length when a polynomial piece is to be continued
/// beyond it.
BasisValues basis_values(const KnotVector& knots, Index span, double t);

/// The same for the derivative of the given order (0: the values themselves); zero beyond the
/// degree.
BasisValues basis_derivatives(const KnotVector& knots, Index span, double t, int order);

/// Greville abscissae: the mean of degree consecutive knots, one per control point (N of them).
std::vector<double> greville_abscissae(const KnotVector& knots);

} // namespace batten
