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
/// or 3, SolverError where points of it differ from the spline's by 1e-12 of its size, or
/// of its largest coordinate where that is more.
TopoDS_Shape shape_of(const Spline& spline);

/// What a shape holds: of faces the surfaces, of edges outside faces the curves, each the part that
/// it is trimmed to.
struct Found {
    std::vector<Spline> splines;
    Index trims_dropped = 0; ///< faces with other boundaries than a rectangle of parameters: whole
    Index others = 0;        ///< faces and edges that are no B-splines: left out
};

/// Throws RationalSpline, and InvalidInput for what is no spline.
Found found_in(const TopoDS_Shape& shape);

} // namespace batten::cad
