#pragma once

#include <batten/basis/basis_functions.hpp>

#include <span>
#include <string_view>
#include <vector>

namespace batten {

/// A B-spline curve, surface or volume: 1 to 3 axes in space of any dimension.
class Spline {
  public:
    Spline() = default;
    /// `control`: (N x dim), N the product of the axes' control counts, last axis fastest; on a
    /// closed axis the last degree slices repeat the first. Throws InvalidInput when the numbers do
    /// not match.
    Spline(std::vector<KnotVector> axes, PointSet control);

    /// Makes the spline of the free control points, repeating those that a closed axis repeats.
    static Spline from_free(std::vector<KnotVector> axes, const PointSet& free_control);

    Index axis_count() const { return static_cast<Index>(axes_.size()); }
    Index dim() const { return control_.dim(); }
    const KnotVector& axis(Index k) const { return axes_[static_cast<std::size_t>(k)]; }
    const std::vector<KnotVector>& axes() const { return axes_; }
    const PointSet& control_points() const { return control_; }
    /// Control points per axis as stored.
    std::vector<Index> control_shape() const;
    /// The control points without a closed axis's repetitions.
    PointSet free_control_points() const;

    /// The point (or its partial derivative of the given orders, one per axis) at one parameter per
    /// axis. Parameters are wrapped on closed axes; outside an open domain the end piece continues.
    std::vector<double> operator()(std::span<const double> parameter,
                                   std::span<const int> orders = {}) const;

  private:
    std::vector<KnotVector> axes_;
    PointSet control_;
};

/// Free control points per axis.
std::vector<Index> free_shape(std::span<const KnotVector> axes);

/// What it is called by its number of axes: curve, surface or volume.
std::string_view kind_name(const Spline& spline);

/// Points at given parameters: scattered (m x axes), one row each. `orders` as in
/// Spline::operator().
PointSet evaluate(const Spline& spline, const Points& parameters, std::span<const int> orders = {});

/// Points over the grid of the axes' parameters, row-major, last axis fastest.
PointSet evaluate_grid(const Spline& spline, const std::vector<std::vector<double>>& axes,
                       std::span<const int> orders = {});

/// The same spline with the knot t added `times` times on `axis`.
/// Throws InvalidInput when t is outside the domain or the multiplicity would exceed the degree.
Spline insert_knot(const Spline& spline, Index axis, double t, int times = 1);

/// The same spline over `refined` knots on `axis`, which must contain the present ones.
Spline refine(const Spline& spline, Index axis, const KnotVector& refined);

/// The same spline with all axes open and clamped: the end knots have full multiplicity, for
/// programs that know no other.
Spline clamped(const Spline& spline);

/// Value of the polar form (blossom) of the polynomial piece over `span` of a curve, at degree
/// arguments: the control point that knots equal to the arguments would have.
std::vector<double> blossom(const KnotVector& knots, const PointSet& control, Index span,
                            std::span<const double> arguments);

} // namespace batten
