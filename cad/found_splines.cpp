#include "geometry.hpp"

#include <batten/core/core.hpp>

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>

namespace batten::cad {

namespace {

constexpr double resolution = 1e-9; // of an axis's length: below it two parameters are one

KnotVector axis_of(int degree, const TColStd_Array1OfReal& values,
                   const TColStd_Array1OfInteger& multiplicities) {
    std::vector<double> knots;
    for (int k = values.Lower(); k <= values.Upper(); ++k)
        knots.insert(knots.end(), static_cast<std::size_t>(multiplicities.Value(k)),
                     values.Value(k));
    return {degree, std::move(knots)};
}

void append(PointSet& control, Index at, const gp_Pnt& p) {
    for (Index d = 0; d < 3; ++d) control(at, d) = p.Coord(static_cast<int>(d) + 1);
}

/// An interval of parameters.
struct Range {
    double first = 0;
    double last = 0;

    double length() const { return last - first; }
    bool ends_at(double t) const {
        constexpr double drawn = 1e-7; // of its length: how exact boundaries are drawn
        return std::min(std::abs(t - first), std::abs(t - last)) <= drawn * length();
    }
};

/// The part of an axis that something is trimmed to; all of it where (nearly) all is left.
Range trimmed(const Range& whole, Range part, bool periodic) {
    if (!periodic) part = {std::max(part.first, whole.first), std::min(part.last, whole.last)};
    if (part.length() >= whole.length() * (1 - resolution)) return whole;
    if (!(part.length() > resolution * whole.length()))
        throw InvalidInput("nothing is left of a spline that is trimmed");
    return part;
}

Spline spline_of(const Handle(Geom_BSplineCurve) & given, const Range& part) {
    if (given->IsRational())
        throw RationalSpline("the curve is rational (its poles have weights); only plain B-splines "
                             "are read");
    const auto curve = Handle(Geom_BSplineCurve)::DownCast(given->Copy());
    const Range whole{curve->FirstParameter(), curve->LastParameter()};
    const Range left = trimmed(whole, part, curve->IsPeriodic());
    if (left.length() < whole.length()) curve->Segment(left.first, left.last);
    if (curve->IsPeriodic()) curve->SetNotPeriodic();
    PointSet control(curve->NbPoles(), 3);
    for (int i = 1; i <= curve->NbPoles(); ++i) append(control, i - 1, curve->Pole(i));
    return clamped(
        {{axis_of(curve->Degree(), curve->Knots(), curve->Multiplicities())}, std::move(control)});
}

Spline spline_of(const Handle(Geom_BSplineSurface) & given, const Range& u_part,
                 const Range& v_part) {
    if (given->IsURational() || given->IsVRational())
        throw RationalSpline(
            "the surface is rational (its poles have weights); only plain B-splines "
            "are read");
    const auto surface = Handle(Geom_BSplineSurface)::DownCast(given->Copy());
    Range u;
    Range v;
    surface->Bounds(u.first, u.last, v.first, v.last);
    const Range u_left = trimmed(u, u_part, surface->IsUPeriodic());
    const Range v_left = trimmed(v, v_part, surface->IsVPeriodic());
    if (u_left.length() < u.length() || v_left.length() < v.length())
        surface->Segment(u_left.first, u_left.last, v_left.first, v_left.last);
    if (surface->IsUPeriodic()) surface->SetUNotPeriodic();
    if (surface->IsVPeriodic()) surface->SetVNotPeriodic();
    const int rows = surface->NbUPoles();
    const int columns = surface->NbVPoles();
    PointSet control(static_cast<Index>(rows) * columns, 3);
    for (int i = 1; i <= rows; ++i)
        for (int j = 1; j <= columns; ++j)
            append(control, static_cast<Index>(i - 1) * columns + j - 1, surface->Pole(i, j));
    return clamped({{axis_of(surface->UDegree(), surface->UKnots(), surface->UMultiplicities()),
                     axis_of(surface->VDegree(), surface->VKnots(), surface->VMultiplicities())},
                    std::move(control)});
}

/// Whether a face's boundary runs along the sides of a rectangle of its parameters.
bool is_rectangle(const TopoDS_Face& face, const Range& u, const Range& v) {
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
        Range t;
        const auto side =
            BRep_Tool::CurveOnSurface(TopoDS::Edge(edges.Current()), face, t.first, t.last);
        if (side.IsNull()) return false;
        constexpr int places = 16;
        for (int k = 0; k <= places; ++k) {
            const gp_Pnt2d at = side->Value(t.first + t.length() * k / places);
            if (!u.ends_at(at.X()) && !v.ends_at(at.Y())) return false;
        }
    }
    return true;
}

void add_face(const TopoDS_Face& face, Found& found) {
    Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    while (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface))
        surface = trimmed->BasisSurface();
    const auto bspline = Handle(Geom_BSplineSurface)::DownCast(surface);
    if (bspline.IsNull()) {
        ++found.others;
        return;
    }
    Range u;
    Range v;
    BRepTools::UVBounds(face, u.first, u.last, v.first, v.last);
    if (!is_rectangle(face, u, v)) {
        ++found.trims_dropped;
        bspline->Bounds(u.first, u.last, v.first, v.last);
    }
    found.splines.push_back(spline_of(bspline, u, v));
}

void add_edge(const TopoDS_Edge& edge, Found& found) {
    Range part;
    Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, part.first, part.last);
    while (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve))
        curve = trimmed->BasisCurve();
    const auto bspline = Handle(Geom_BSplineCurve)::DownCast(curve);
    if (bspline.IsNull())
        ++found.others;
    else
        found.splines.push_back(spline_of(bspline, part));
}

} // namespace

Found found_in(const TopoDS_Shape& shape) {
    Found found;
    for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next())
        add_face(TopoDS::Face(faces.Current()), found);
    for (TopExp_Explorer edges(shape, TopAbs_EDGE, TopAbs_FACE); edges.More(); edges.Next())
        add_edge(TopoDS::Edge(edges.Current()), found);
    return found;
}

} // namespace batten::cad
