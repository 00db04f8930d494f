// Open CASCADE and SISL on a file of points: for every line "NAME TOLERANCE" prints milliseconds,
// control points and the largest distance of a sample from the result (by batten's closest points).
// Never linked into the product.
#include <batten/batten.hpp>

#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iostream>
#include <sisl.h>
#include <sstream>

namespace {

using namespace batten;
using Clock = std::chrono::steady_clock;

gp_Pnt point(std::span<const double> p) {
    return {p[0], p[1], p.size() > 2 ? p[2] : 0.0};
}

struct Outcome {
    double time;
    Spline spline;
};

KnotVector flat_knots(int degree, const TColStd_Array1OfReal& knots,
                      const TColStd_Array1OfInteger& multiplicities) {
    std::vector<double> flat;
    for (int k = knots.Lower(); k <= knots.Upper(); ++k)
        flat.insert(flat.end(), static_cast<std::size_t>(multiplicities(k)), knots(k));
    return {degree, std::move(flat)};
}

Outcome open_cascade_curve(const Samples& samples, double tolerance) {
    TColgp_Array1OfPnt points(1, static_cast<int>(samples.size()));
    for (Index i = 0; i < samples.size(); ++i)
        points(static_cast<int>(i) + 1) = point(samples.points[i]);
    const auto start = Clock::now();
    const GeomAPI_PointsToBSpline fit(points, 3, 3, GeomAbs_C2, tolerance);
    const double time = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    const Handle(Geom_BSplineCurve)& curve = fit.Curve();
    PointSet control(curve->NbPoles(), samples.dim());
    for (int i = 1; i <= curve->NbPoles(); ++i)
        for (Index d = 0; d < samples.dim(); ++d)
            control(i - 1, d) = curve->Pole(i).Coord(static_cast<int>(d) + 1);
    return {time,
            Spline({flat_knots(3, curve->Knots(), curve->Multiplicities())}, std::move(control))};
}

Outcome open_cascade_surface(const Samples& samples, double tolerance) {
    TColgp_Array2OfPnt points(1, static_cast<int>(samples.grid[0]), 1,
                              static_cast<int>(samples.grid[1]));
    for (Index i = 0; i < samples.size(); ++i)
        points(static_cast<int>(i / samples.grid[1]) + 1,
               static_cast<int>(i % samples.grid[1]) + 1) = point(samples.points[i]);
    const auto start = Clock::now();
    const GeomAPI_PointsToBSplineSurface fit(points, 3, 3, GeomAbs_C2, tolerance);
    const double time = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    const Handle(Geom_BSplineSurface)& s = fit.Surface();
    PointSet control(s->NbUPoles() * s->NbVPoles(), 3);
    Index at = 0;
    for (int i = 1; i <= s->NbUPoles(); ++i)
        for (int j = 1; j <= s->NbVPoles(); ++j, ++at)
            for (int d = 0; d < 3; ++d) control(at, d) = s->Pole(i, j).Coord(d + 1);
    return {time, Spline({flat_knots(s->UDegree(), s->UKnots(), s->UMultiplicities()),
                          flat_knots(s->VDegree(), s->VKnots(), s->VMultiplicities())},
                         std::move(control))};
}

Outcome sisl_curve(const Samples& samples, double tolerance) {
    std::vector<double> points(samples.points.data(),
                               samples.points.data() + samples.size() * samples.dim());
    const int dim = static_cast<int>(samples.dim());
    std::vector<double> tolerances(static_cast<std::size_t>(dim),
                                   tolerance / std::sqrt(static_cast<double>(dim)));
    std::vector<double> errors(static_cast<std::size_t>(dim));
    SISLCurve* curve = nullptr;
    int status = 0;
    const auto start = Clock::now();
    s1961(points.data(), static_cast<int>(samples.size()), dim, 1, nullptr, tolerances.data(), 0, 0,
          1, 1e-12, 30, 4, &curve, errors.data(), &status);
    const double time = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (status < 0 || curve == nullptr)
        throw SolverError(fmt::format("SISL s1961 returned {}", status));
    std::vector<double> knots(curve->et, curve->et + curve->in + curve->ik);
    Outcome outcome{
        time,
        Spline({KnotVector(curve->ik - 1, std::move(knots))},
               PointSet(std::vector<double>(curve->ecoef, curve->ecoef + curve->in * dim), dim))};
    freeCurve(curve);
    return outcome;
}

} // namespace

int main(int, char** argv) {
    const Samples samples = read_points(argv[1]);
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string name;
        double tolerance = 0;
        words >> name >> tolerance;
        try {
            const Outcome o = name == "sisl"         ? sisl_curve(samples, tolerance)
                              : samples.grid.empty() ? open_cascade_curve(samples, tolerance)
                                                     : open_cascade_surface(samples, tolerance);
            double largest = 0;
            if (samples.grid.empty())
                for (const ClosestPoint& c : closest_points(o.spline, samples.points))
                    largest = std::max(largest, c.distance);
            fmt::print("{} {} {}\n", o.time, fmt::join(o.spline.control_shape(), "x"), largest);
        } catch (const std::exception& error) {
            fmt::print("failed {}\n", error.what());
        }
        std::fflush(stdout);
    }
}
