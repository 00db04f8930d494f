#pragma once

#include <batten/spline/spline.hpp>

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Shape.hxx>

namespace batten::cad {

/// A curve or surface whose poles have weights.
class RationalSpline : public InvalidInput {
  public:
    using InvalidInput::InvalidInput;
};

/// The spline as an edge or a face; throws InvalidInput for a volume, or a dimension other than 2
/// or 3, SolverError where points of it differ from the spline's by 1e-12 of its size.
TopoDS_Shape shape_of(const Spline& spline);

/// All B-spline curves and surfaces in a shape: of faces the surfaces, of edges outside faces the
/// curves. Throws RationalSpline, and InvalidInput for what is no spline.
std::vector<Spline> splines_of(const TopoDS_Shape& shape);

} // namespace batten::cad
