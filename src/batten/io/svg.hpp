#pragma once

#include <batten/io/spline_file.hpp>

namespace batten {

/// Picture of a planar curve: the curve as exact cubic Beziers (degree above 3: a close polyline),
/// the samples and the control polygon. Throws InvalidInput unless the spline is a curve in the
/// plane.
std::string svg_picture(const Scene& scene);

} // namespace batten
