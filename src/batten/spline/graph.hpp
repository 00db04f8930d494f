#pragma once

#include <batten/spline/spline.hpp>

namespace batten {

/// Whether it has one value per parameter: a function of one to three variables.
inline bool is_function(const Spline& spline) {
    return spline.dim() == 1;
}

/// The graph of a function over its parameters: the spline of points (parameters..., value), exact,
/// the control points' parameters the Greville abscissae [PieglTiller1997, section 9.2]. Its axes
/// are open.
Spline graph(const Spline& function);

/// What is drawn of it: the spline itself, of a function its graph.
inline Spline drawn(const Spline& spline) {
    return is_function(spline) ? graph(spline) : spline;
}

} // namespace batten
