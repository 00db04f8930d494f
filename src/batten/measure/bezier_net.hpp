#pragma once

#include <batten/spline/bezier_pieces.hpp>

namespace batten {

/// One boundary of a net: all of it where one axis is at an end.
struct Face {
    std::size_t axis;
    AxisEnd end;
};

/// Bezier control points of a polynomial piece, or of a box of its parameters.
struct BezierNet {
    PerAxis<int> degrees{};  ///< 0 where it has no extent
    PerAxis<double> begin{}; ///< its box in the piece's parameters, 0 to 1
    PerAxis<double> width{1, 1, 1};
    std::vector<double> values{}; ///< dim x coefficients(), last axis fastest; may be longer

    Index coefficients() const { return (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1); }
    /// Distance in `values` between neighbours along an axis.
    Index stride(std::size_t axis) const;
    /// The place in the piece of a place in the net, 0 to 1 along each axis.
    PerAxis<double> in_piece(const PerAxis<double>& local) const;
    /// The reverse; limited to 0 to 1.
    PerAxis<double> in_net(const PerAxis<double>& place) const;
    /// Whether the net's box contains a place of the piece.
    bool contains(const PerAxis<double>& place) const;
};

/// Upper bounds of the net's extent along each axis: the degree times its longest control leg.
PerAxis<double> extents(const BezierNet& net, Index dim);

/// Lower bound of the squared distance from the origin: that of the control points' box.
double box_square(const BezierNet& net, Index dim);

/// Makes the net its own face.
void collapse(BezierNet& net, Index dim, const Face& face);

/// Makes the net its own half before or after the middle of an axis and writes the other half to
/// `rest`.
void halve(BezierNet& net, Index dim, std::size_t axis, AxisEnd kept, BezierNet& rest);

} // namespace batten
