#pragma once

#include <batten/io/spline_file.hpp>

namespace batten {

/// Picture of a planar curve: the curve as exact cubic Beziers (degree above 3: a polyline within a
/// twentieth of a pixel), the samples (coloured by deviation where it is known) and the control
/// polygon; of anything else in space its projection; of a function of one or two variables its
/// graph, filling the picture. Throws InvalidInput for dimensions above 3.
std::string svg_picture(const Scene& scene);

/// Curves, surfaces and volumes in space seen from the front, the left and above: faces shaded with
/// their iso-lines, the far ones first, and the samples coloured by deviation.
std::string svg_projection(const Scene& scene);

} // namespace batten
