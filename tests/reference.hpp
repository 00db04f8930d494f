#pragma once

#include <batten/batten.hpp>

#include <Eigen/Core>

/// What the tests judge by: B-splines from their definition and dense linear algebra, in extended
/// precision. Of the library only the numbers in its types are used, none of its algorithms.
namespace batten::reference {

using Long = long double;
using Matrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

/// The k with t_k <= t < t_{k+1} inside the domain, the last such k at its end.
Index span_of(const KnotVector& k, Long t);

/// Derivative of the given order at t of N_{i,p} on the piece `span`: the recursion of Cox and de
/// Boor [PieglTiller1997, eq. 2.5 and 2.7].
Long basis(const KnotVector& k, Index span, Index i, int p, Long t, int order = 0);

/// (m x stored control points) of one axis: every B-spline at every parameter of the domain.
Matrix stored_collocation(const KnotVector& k, const std::vector<double>& t, int order = 0);

/// The same over the free control points: on a closed axis the last ones repeat the first.
Matrix collocation(const KnotVector& k, const std::vector<double>& t, int order = 0);

/// Rows of the second inside every row of the first: the last axis is fastest.
Matrix kronecker(const Matrix& a, const Matrix& b);

/// (m x free control points) of scattered parameters (m x axes), derivatives of the given orders.
Matrix scattered_collocation(const std::vector<KnotVector>& axes, const Points& parameters,
                             const std::vector<int>& orders = {});

Matrix matrix(const Points& points);

PointSet points(const Matrix& m);

/// The point or derivative of a spline at one parameter per axis, from its stored control points.
Eigen::Matrix<Long, 1, Eigen::Dynamic> point(const Spline& spline,
                                             const std::vector<double>& parameter,
                                             const std::vector<int>& orders = {});

/// A curve's points at its parameters, (m x dim).
Matrix curve_points(const Spline& curve, const std::vector<double>& t, int order = 0);

/// Distance of each sample from the spline's point at its own parameter.
std::vector<double> deviations(const Spline& spline, const Points& samples,
                               const Parameters& parameters);

double largest(const std::vector<double>& values);

/// A B and A^T B.
Matrix product(const Matrix& a, const Matrix& b);
Matrix transposed_product(const Matrix& a, const Matrix& b);

/// The X with A X = B, A square, by full pivoting.
Matrix solve(const Matrix& a, const Matrix& b);

/// The same, A symmetric and positive definite, by Cholesky's factors.
Matrix solve_definite(const Matrix& a, const Matrix& b);

/// Singular values in double precision, the largest first.
std::vector<double> singular_values(const Matrix& a);

/// Number of pivots above the threshold times the largest, by full pivoting.
Index rank(const Matrix& a, double threshold);

/// Largest absolute value of an eigenvalue, in double precision.
double spectral_radius(const Matrix& a);

/// The P that minimises |A P - Q|, by Householder's QR.
Matrix least_squares(const Matrix& a, const Matrix& q);

/// The P that minimises |A P - Q| among those with C P = D: the saddle point by full pivoting.
Matrix least_squares(const Matrix& a, const Matrix& q, const Matrix& c, const Matrix& d);

/// Largest difference of a coordinate.
double difference(const Matrix& expected, const Points& found);

} // namespace batten::reference
