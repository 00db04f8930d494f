#pragma once

#include <batten/spline/spline.hpp>

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Shape.hxx>

namespace batten::cad {

/// The spline as an edge or a face; throws InvalidInput for a volume, or a dimension other than 2
/// or 3.
TopoDS_Shape shape_of(const Spline& spline);

/// All B-spline curves and surfaces in a shape: of faces the surfaces, of edges outside faces the
/// curves. Throws InvalidInput for rational ones.
std::vector<Spline> splines_of(const TopoDS_Shape& shape);

} // namespace batten::cad
