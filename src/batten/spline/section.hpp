#pragma once

#include <batten/spline/spline.hpp>

namespace batten {

/// The spline over the other axes where `axis` is held at the parameter t: a curve of a surface, a
/// surface of a volume. Throws InvalidInput when there is no other axis.
Spline section(const Spline& spline, Index axis, double t);

} // namespace batten
