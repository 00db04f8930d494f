// Splines of every degree on uneven knots, of any size and place, as Open CASCADE reads them from
// STEP and IGES, against de Boor's algorithm in extended precision.
#include "cad_formats.hpp"
#include "test_folder.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/io/output_file.hpp>

#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <UnitsMethods.hxx>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

namespace batten {
namespace {

using Wide = long double;

/// The weights of the stored control points at t.
std::vector<Wide> weights_at(const KnotVector& axis, double t) {
    const int p = axis.degree();
    const Index span = axis.span(t);
    std::vector<Wide> weights(static_cast<std::size_t>(axis.control_count()), 0);
    for (int r = 0; r <= p; ++r) { // de Boor's triangle for a unit control point
        std::vector<Wide> d(static_cast<std::size_t>(p + 1), 0);
        d[static_cast<std::size_t>(r)] = 1;
        for (int level = 1; level <= p; ++level)
            for (int k = p; k >= level; --k) {
                const Index i = span - p + k;
                const Wide low = axis[i];
                const Wide part = (t - low) / (axis[i + p - level + 1] - low);
                const auto at = static_cast<std::size_t>(k);
                d[at] = (1 - part) * d[at - 1] + part * d[at];
            }
        weights[static_cast<std::size_t>(span - p + r)] = d.back();
    }
    return weights;
}

std::array<double, 3> exact_point(const Spline& spline, const std::vector<double>& t) {
    std::array<Wide, 3> sum{};
    std::vector<Wide> rows = weights_at(spline.axis(0), t[0]);
    const std::vector<Wide> columns =
        t.size() > 1 ? weights_at(spline.axis(1), t[1]) : std::vector<Wide>{1};
    Index at = 0;
    for (Wide row : rows)
        for (Wide column : columns) {
            for (Index d = 0; d < spline.dim(); ++d)
                sum[static_cast<std::size_t>(d)] +=
                    row * column * static_cast<Wide>(spline.control_points()(at, d));
            ++at;
        }
    return {static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])};
}

/// Splines by number: uneven knots, on some a millionth apart, closed ones, knots that do not end
/// clamped, small and large ones, far from the origin.
class Cases {
  public:
    explicit Cases(unsigned seed) : random_(seed) {}

    KnotVector axis(int degree) {
        std::vector<double> interior(2 + random_() % 8 + static_cast<std::size_t>(degree));
        for (double& t : interior) t = unit();
        if (random_() % 2 == 0) interior.back() = interior.front() + std::pow(10, -1 - 5 * unit());
        for (double& t : interior) t = std::min(t, 1.0);
        std::erase_if(interior, [](double t) { return t <= 0 || t >= 1; });
        std::ranges::sort(interior);
        switch (random_() % 3) {
        case 0:
            return knots_around(degree, interior, 0, 1);
        case 1:
            return knots_around(degree, interior, 0, 1, Closure::closed);
        default:
            break;
        }
        for (int k = 0; k <= degree; ++k) { // the domain's ends and beyond
            interior.insert(interior.begin(), k == 0 ? 0 : interior.front() - 0.1 * unit());
            interior.push_back(k == 0 ? 1 : interior.back() + 0.1 * unit());
        }
        return {degree, interior};
    }

    Spline spline(std::vector<KnotVector> axes, double size) {
        Index count = 1;
        for (Index n : free_shape(axes)) count *= n;
        const double offset = random_() % 3 == 0 ? 1e6 * size : 0;
        PointSet control(count, 2 + static_cast<Index>(axes.size() > 1 || random_() % 2 == 0));
        for (double& x : control.values()) x = offset + size * unit();
        return Spline::from_free(std::move(axes), control);
    }

    double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  private:
    std::mt19937 random_;
};

TopoDS_Shape read_back(const std::string& name, const std::string& content) {
    const std::filesystem::path path = in_test_folder(name);
    write_file(path, content);
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    if (name.ends_with(".step")) {
        STEPControl_Reader reader;
        EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
        reader.TransferRoots();
        return reader.OneShape();
    }
    IGESControl_Reader reader;
    UnitsMethods::SetCasCadeLengthUnit(1.0);
    Interface_Static::SetIVal("read.iges.bspline.continuity", 0);
    EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
    reader.TransferRoots();
    return reader.OneShape();
}

/// Parameters over the domain: in every piece, and everywhere.
std::vector<double> places(const KnotVector& axis) {
    std::vector<double> t;
    const std::vector<double> breaks = axis.breakpoints();
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        for (double part : {0.02, 0.3, 0.7, 0.98})
            t.push_back(breaks[b] + part * (breaks[b + 1] - breaks[b]));
    return t;
}

/// The largest distance of what stands in a file, as a part of the largest coordinate.
double away(const Spline& spline, const TopoDS_Shape& shape) {
    double largest = 0;
    for (double x : spline.control_points().values()) largest = std::max(largest, std::abs(x));
    double worst = 0;
    const auto compare = [&](const gp_Pnt& theirs, const std::vector<double>& t) {
        const auto exact = exact_point(spline, t);
        worst = std::max(worst, theirs.Distance({exact[0], exact[1], exact[2]}) / largest);
    };
    if (spline.axis_count() == 1) {
        TopExp_Explorer edges(shape, TopAbs_EDGE);
        if (!edges.More()) return INFINITY;
        double first = 0;
        double last = 0;
        const auto curve = BRep_Tool::Curve(TopoDS::Edge(edges.Current()), first, last);
        for (double t : places(spline.axis(0))) compare(curve->Value(t), {t});
        return worst;
    }
    TopExp_Explorer faces(shape, TopAbs_FACE);
    if (!faces.More()) return INFINITY;
    const auto surface = BRep_Tool::Surface(TopoDS::Face(faces.Current()));
    for (double u : places(spline.axis(0)))
        for (double v : places(spline.axis(1))) compare(surface->Value(u, v), {u, v});
    return worst;
}

TEST(CadExact, files_hold_the_spline) {
    Cases cases(1);
    for (int degree = 1; degree <= max_degree; ++degree)
        for (double size : {1e-6, 1e-3, 1.0, 1e6})
            for (int kind = 0; kind < 6; ++kind) {
                std::vector<KnotVector> axes{cases.axis(degree)};
                if (kind > 3) axes.push_back(cases.axis(1 + (degree + kind) % max_degree));
                const Spline spline = cases.spline(axes, size);
                const Scene scene{.spline = spline, .title = "case"};
                const std::string what = fmt::format("degree {}, size {}, kind {}, seam {}", degree,
                                                     size, kind, axes[0].closed());
                EXPECT_LT(away(spline, read_back("e.step", cad::step_text(scene))), 1e-13) << what;
                EXPECT_LT(away(spline, read_back("e.igs", cad::iges_text(scene))), 1e-13) << what;
            }
}

} // namespace
} // namespace batten
