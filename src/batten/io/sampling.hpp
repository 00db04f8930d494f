#pragma once

#include <batten/spline/spline.hpp>

#include <span>
#include <vector>

namespace batten {

/// Parameters per axis, breakpoints among them.
using AxisPlaces = std::vector<std::vector<double>>;

/// Parameters so dense that flat pieces between the points there are within `chord`: a curve's
/// chords, both triangles of a surface's cells, and of those on a volume's faces, by either
/// diagonal, a volume's trilinear cells. A surface that is closed, or ends in points, gets cells
/// enough to enclose what it encloses; a spline that is one point gets one. A file that moves
/// points by `moved` leaves so much less of the chord, half of it at least. At most 10^7 points;
/// throws InvalidInput when these do not suffice, or double precision does not, or `chord` is not
/// positive.
AxisPlaces sampling(const Spline& spline, double chord, double moved = 0);

/// Parameters so dense that this holds for the six faces of a volume.
AxisPlaces skin_sampling(const Spline& volume, double chord, double moved = 0);

/// Parameters at `pieces` equal parts of every span between two breaks, one count per span.
std::vector<double> divided(const std::vector<double>& breaks, const std::vector<Index>& pieces);

/// The middle of the control points' box.
std::vector<double> centre_of(const Spline& spline);

/// The spline with its control points relative to a point: small numbers are rounded little.
Spline about(const Spline& spline, const std::vector<double>& centre);

/// Whether the spline's two ends along the axis are one: a closed axis, or ends that coincide. The
/// graph of a function has two ends everywhere.
bool meets_itself(const Spline& spline, Index axis);

/// How far coordinates may be apart that are one but for rounding: 10^-12 of the size.
double same_point_distance(const Spline& spline);

/// Whether no coordinate differs by more than `apart`.
bool is_same_point(std::span<const double> a, std::span<const double> b, double apart);

/// How far a point may be moved when its coordinates are rounded to numbers of that relative
/// precision.
double rounding(const Spline& spline, double epsilon);

/// A part of the control points' diagonal, or what rounding leaves of it: the chord that is kept
/// where none is stated, and that pictures are drawn to.
double picture_chord(const Spline& spline, double parts = 1000);

} // namespace batten
