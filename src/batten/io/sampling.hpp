#pragma once

#include <batten/spline/spline.hpp>

#include <vector>

namespace batten {

/// Parameters per axis, breakpoints among them, so dense that between neighbouring ones a curve is
/// within `chord` of its chord and a surface or volume of its cells' flat faces. At most about 10^7
/// points in all; throws InvalidInput when these do not suffice or `chord` is not positive.
std::vector<std::vector<double>> sampling(const Spline& spline, double chord);

/// A thousandth of the control points' diagonal: the chord that pictures are drawn to.
double picture_chord(const Spline& spline);

} // namespace batten
