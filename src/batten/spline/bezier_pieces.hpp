#pragma once

#include <batten/spline/spline.hpp>

#include <array>
#include <vector>

namespace batten {

/// One number per axis of a spline of 1 to 3 axes, its own axes last: a curve's are {x, x, own}.
template <class T>
using PerAxis = std::array<T, 3>;

using AxisMatrix = PerAxis<PerAxis<double>>;

/// A place on a spline: a polynomial piece, and where in it (0 to 1 along each axis).
struct PlaceInPiece {
    Index piece = 0;
    PerAxis<double> local{};
};

/// The polynomial pieces of a spline as Bezier control points, made when asked for, in coordinates
/// that hold at every scale: relative to the middle of the control points' box, times the power of
/// two that makes its longest edge 1 to 2.
class BezierPieces {
  public:
    explicit BezierPieces(const Spline& spline);

    Index axis_count() const { return axis_count_; }
    Index dim() const { return dim_; }
    /// Degrees, 0 where the spline has no axis.
    const PerAxis<int>& degrees() const { return degrees_; }
    /// Pieces along each axis, 1 where the spline has none; the last axis is the fastest.
    const PerAxis<Index>& shape() const { return shape_; }
    Index count() const { return shape_[0] * shape_[1] * shape_[2]; }
    /// Control points of one piece.
    Index coefficients() const;
    /// Longest edge of the box in the coordinates used here: 1 to 2, or 0 for a single point.
    double size() const { return size_; }

    /// Writes the piece's control points to `net` (dim x coefficients, last axis fastest).
    void load(Index piece, std::span<double> net) const;
    /// Writes the point (dim) in the coordinates used here to `local`.
    void localise(std::span<const double> point, std::span<double> local) const;
    /// A length of the coordinates used here in the spline's own.
    double in_own_units(double length) const;

    /// One parameter per axis of the spline.
    std::vector<double> parameter(const PlaceInPiece& place) const;
    /// The place of a parameter, which is wrapped on closed axes and moved to the end of open ones.
    PlaceInPiece place(std::span<const double> parameter) const;

  private:
    /// What one axis contributes: its pieces' ends, and the maps from B-spline to Bezier control
    /// points.
    struct Axis {
        KnotVector knots;
        std::vector<double> breaks;
        std::vector<Index> first; // first control point that matters, per piece
        std::vector<double> maps; // (degree + 1) x (degree + 1) per piece
        Index stride = 1;         // between neighbouring control points
    };

    void normalise(const PointSet& control);
    PerAxis<Index> along_axes(Index piece) const;

    Index axis_count_;
    Index dim_;
    PerAxis<int> degrees_{};
    PerAxis<Index> shape_{1, 1, 1};
    PerAxis<Axis> axes_;
    std::vector<double> control_; // dim x control points
    std::vector<double> origin_;
    int exponent_ = 0;
    double size_ = 0;
};

} // namespace batten
