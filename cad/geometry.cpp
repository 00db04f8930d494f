#include "geometry.hpp"

#include <batten/core/core.hpp>
#include <batten/io/format_limits.hpp>
#include <batten/samples/samples.hpp>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten::cad {

namespace {

struct Knots {
    TColStd_Array1OfReal values;
    TColStd_Array1OfInteger multiplicities;
};

/// The distinct knots of a clamped axis and how often each stands.
Knots knots_of(const KnotVector& axis) {
    const std::vector<double> distinct = axis.breakpoints();
    const auto count = static_cast<int>(distinct.size());
    Knots result{{1, count}, {1, count}};
    for (int k = 1; k <= count; ++k) {
        const double value = distinct[static_cast<std::size_t>(k - 1)];
        result.values.SetValue(k, value);
        result.multiplicities.SetValue(k,
                                       static_cast<int>(std::ranges::count(axis.knots(), value)));
    }
    return result;
}

gp_Pnt point(std::span<const double> p) {
    return {p[0], p[1], p.size() > 2 ? p[2] : 0.0};
}

Handle(Geom_BSplineCurve) curve_of(const Spline& spline) {
    const PointSet& control = spline.control_points();
    TColgp_Array1OfPnt poles(1, static_cast<int>(control.size()));
    for (Index i = 0; i < control.size(); ++i)
        poles.SetValue(static_cast<int>(i) + 1, point(control[i]));
    const Knots knots = knots_of(spline.axis(0));
    return new Geom_BSplineCurve(poles, knots.values, knots.multiplicities,
                                 spline.axis(0).degree());
}

Handle(Geom_BSplineSurface) surface_of(const Spline& spline) {
    const std::vector<Index> shape = spline.control_shape();
    TColgp_Array2OfPnt poles(1, static_cast<int>(shape[0]), 1, static_cast<int>(shape[1]));
    for (Index i = 0; i < shape[0]; ++i)
        for (Index j = 0; j < shape[1]; ++j)
            poles.SetValue(static_cast<int>(i) + 1, static_cast<int>(j) + 1,
                           point(spline.control_points()[i * shape[1] + j]));
    const Knots u = knots_of(spline.axis(0));
    const Knots v = knots_of(spline.axis(1));
    return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities,
                                   spline.axis(0).degree(), spline.axis(1).degree());
}

/// Throws SolverError where Open CASCADE's point and ours differ by what more than rounding makes.
void check_point(const gp_Pnt& theirs, std::span<const double> ours, double size) {
    constexpr double part = 1e-12; // of the size
    double square = 0;
    for (std::size_t d = 0; d < ours.size(); ++d) {
        const double gap = theirs.Coord(static_cast<int>(d) + 1) - ours[d];
        square += gap * gap;
    }
    if (!(std::sqrt(square) <= part * size))
        throw SolverError(fmt::format("Open CASCADE's spline is off by {:.3g}", std::sqrt(square)));
}

/// Largest coordinate, or distance between control points where that is larger.
double size_of(const Spline& spline) {
    double largest = diagonal(spline.control_points());
    for (double x : spline.control_points().values()) largest = std::max(largest, std::abs(x));
    return largest;
}

/// Parameters in all pieces: so many in each.
std::vector<double> in_pieces(const KnotVector& axis, int count) {
    std::vector<double> t;
    const std::vector<double> breaks = axis.breakpoints();
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        for (int k = 0; k < count; ++k)
            t.push_back(breaks[b] + (breaks[b + 1] - breaks[b]) * (k + 0.5) / count);
    return t;
}

/// A curve of degree p is known by p + 1 points of each piece.
void check_curve(const Geom_BSplineCurve& curve, const Spline& spline) {
    const std::vector<double> t = in_pieces(spline.axis(0), spline.axis(0).degree() + 1);
    const PointSet exact = evaluate_grid(spline, {t});
    const double size = size_of(spline);
    for (std::size_t i = 0; i < t.size(); ++i)
        check_point(curve.Value(t[i]), exact[static_cast<Index>(i)], size);
}

/// One point of each piece: what moves a control point moves some of them.
void check_surface(const Geom_BSplineSurface& surface, const Spline& spline) {
    const std::vector<double> u = in_pieces(spline.axis(0), 1);
    const std::vector<double> v = in_pieces(spline.axis(1), 1);
    const PointSet exact = evaluate_grid(spline, {u, v});
    const double size = size_of(spline);
    for (std::size_t i = 0; i < u.size(); ++i)
        for (std::size_t j = 0; j < v.size(); ++j)
            check_point(surface.Value(u[i], v[j]), exact[static_cast<Index>(i * v.size() + j)],
                        size);
}

} // namespace

TopoDS_Shape shape_of(const Spline& spline) {
    check(cad_limits, spline.axis_count(), spline.dim());
    const Spline open = clamped(spline);
    if (spline.axis_count() == 1) {
        const auto curve = curve_of(open);
        check_curve(*curve, spline);
        BRepBuilderAPI_MakeEdge edge(curve);
        if (!edge.IsDone()) throw InvalidInput("the curve is too short for a CAD file's precision");
        return edge.Edge();
    }
    const auto surface = surface_of(open);
    check_surface(*surface, spline);
    BRepBuilderAPI_MakeFace face(surface, Precision::Confusion());
    if (!face.IsDone()) throw InvalidInput("the surface is too small for a CAD file's precision");
    return face.Face();
}

} // namespace batten::cad
