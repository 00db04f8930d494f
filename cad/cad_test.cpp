// What is written is read back by Open CASCADE itself: degrees, knots, poles, closure, unit,
// validity.
#include "cad_formats.hpp"
#include "test_folder.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/fit/fit.hpp>
#include <batten/io/output_file.hpp>
#include <batten/samples/generate.hpp>

#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <UnitsMethods.hxx>
#include <algorithm>
#include <gtest/gtest.h>

namespace batten {
namespace {

Spline rose() {
    return fit(generate("rose", {}), {.tolerance = {.value = 1e-2}}).spline;
}

/// A closed curve with a corner at its seam.
Spline closed_naca() {
    FitOptions options{.tolerance = {.value = 1e-3}};
    options.shape.closures = {Closure::closed};
    return fit(generate("naca2412", {}), options).spline;
}

Spline peaks() {
    return fit(generate("peaks", {}), {.shape = {.control_points = {20, 30}}}).spline;
}

std::filesystem::path file(const std::string& name, const std::string& content) {
    const std::filesystem::path path = in_test_folder(name);
    write_file(path, content);
    return path;
}

TopoDS_Shape read_step(const std::filesystem::path& path, std::string& unit) {
    STEPControl_Reader reader;
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
    TColStd_SequenceOfAsciiString lengths;
    TColStd_SequenceOfAsciiString angles;
    TColStd_SequenceOfAsciiString solid_angles;
    reader.FileUnits(lengths, angles, solid_angles);
    unit = lengths.First().ToCString();
    reader.TransferRoots();
    return reader.OneShape();
}

TopoDS_Shape read_iges(const std::filesystem::path& path, std::string& unit) {
    IGESControl_Reader reader;
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    UnitsMethods::SetCasCadeLengthUnit(1.0);
    Interface_Static::SetIVal("read.iges.bspline.continuity", 0); // keep corners as they are
    EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
    IGESData_GlobalSection global = reader.IGESModel()->GlobalSection();
    unit = global.UnitName()->ToCString();
    global.SetCascadeUnit(1.0);
    reader.IGESModel()->SetGlobalSection(global);
    reader.TransferRoots();
    return reader.OneShape();
}

void expect_knots(const KnotVector& ours, const TColStd_Array1OfReal& knots,
                  const TColStd_Array1OfInteger& multiplicities) {
    std::vector<double> theirs;
    for (int k = knots.Lower(); k <= knots.Upper(); ++k)
        theirs.insert(theirs.end(), static_cast<std::size_t>(multiplicities.Value(k)),
                      knots.Value(k));
    ASSERT_EQ(theirs.size(), ours.knots().size());
    for (std::size_t k = 0; k < theirs.size(); ++k)
        EXPECT_NEAR(theirs[k], ours.knots()[k], 1e-15 * ours.length());
}

void expect_point(const gp_Pnt& theirs, std::span<const double> ours, double size) {
    for (std::size_t d = 0; d < 3; ++d)
        EXPECT_NEAR(theirs.Coord(static_cast<int>(d) + 1), d < ours.size() ? ours[d] : 0.0,
                    1e-14 * size);
}

void expect_curve(const TopoDS_Shape& shape, const Spline& spline, double factor) {
    TopExp_Explorer edges(shape, TopAbs_EDGE);
    ASSERT_TRUE(edges.More());
    double first = 0;
    double last = 0;
    const auto curve = Handle(Geom_BSplineCurve)::DownCast(
        BRep_Tool::Curve(TopoDS::Edge(edges.Current()), first, last)->Copy());
    ASSERT_FALSE(curve.IsNull());
    if (curve->IsPeriodic()) // as Open CASCADE reads a closed curve
        curve->Segment(curve->FirstParameter(), curve->LastParameter());
    EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
    const Spline open = clamped(spline);
    EXPECT_EQ(curve->Degree(), open.axis(0).degree());
    EXPECT_FALSE(curve->IsRational());
    EXPECT_EQ(curve->IsClosed(), spline.axis(0).closed());
    expect_knots(open.axis(0), curve->Knots(), curve->Multiplicities());
    const double size = diagonal(spline.control_points());
    ASSERT_EQ(curve->NbPoles(), open.control_points().size());
    for (int i = 1; i <= curve->NbPoles(); ++i) {
        gp_Pnt pole = curve->Pole(i);
        pole.SetXYZ(pole.XYZ() / factor);
        expect_point(pole, open.control_points()[i - 1], size);
    }
    // the clamped one is the same curve
    for (double t = 0; t <= 1; t += 1.0 / 64) {
        gp_Pnt p = curve->Value(t);
        p.SetXYZ(p.XYZ() / factor);
        expect_point(p, spline(std::array{t}), size);
    }
}

TEST(Cad, curves_come_back_from_step_and_iges) {
    for (const Spline& spline : {rose(), closed_naca()}) {
        const Scene scene{.spline = spline, .title = "rose"};
        std::string unit;
        expect_curve(read_step(file("c.step", cad::step_text(scene)), unit), spline, 1);
        EXPECT_EQ(unit, "millimetre");
        expect_curve(read_iges(file("c.igs", cad::iges_text(scene)), unit), spline, 1);
        EXPECT_EQ(unit, "MM");
    }
}

TEST(Cad, surfaces_come_back_from_step_and_iges) {
    const Spline spline = peaks();
    const Scene scene{.spline = spline, .title = "peaks"};
    std::string unit;
    for (const TopoDS_Shape& shape : {read_step(file("s.step", cad::step_text(scene)), unit),
                                      read_iges(file("s.igs", cad::iges_text(scene)), unit)}) {
        TopExp_Explorer faces(shape, TopAbs_FACE);
        ASSERT_TRUE(faces.More());
        const auto surface = Handle(Geom_BSplineSurface)::DownCast(
            BRep_Tool::Surface(TopoDS::Face(faces.Current())));
        ASSERT_FALSE(surface.IsNull());
        EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
        EXPECT_EQ(surface->UDegree(), 3);
        EXPECT_EQ(surface->VDegree(), 3);
        EXPECT_FALSE(surface->IsUClosed() || surface->IsVClosed());
        expect_knots(spline.axis(0), surface->UKnots(), surface->UMultiplicities());
        expect_knots(spline.axis(1), surface->VKnots(), surface->VMultiplicities());
        ASSERT_EQ(surface->NbUPoles(), 20);
        ASSERT_EQ(surface->NbVPoles(), 30);
        const double size = diagonal(spline.control_points());
        for (int i = 0; i < 20; ++i)
            for (int j = 0; j < 30; ++j)
                expect_point(surface->Pole(i + 1, j + 1), spline.control_points()[i * 30 + j],
                             size);
    }
}

TEST(Cad, coordinates_stay_and_the_unit_is_named) {
    const Spline spline = rose();
    const struct {
        const char* unit;
        const char* step;
        const char* iges;
        double millimetres;
    } cases[] = {{"mm", "millimetre", "MM", 1},
                 {"cm", "centimetre", "CM", 10},
                 {"m", "metre", "M", 1000},
                 {"in", "INCH", "INCH", 25.4}};
    for (const auto& c : cases) {
        const Scene scene{.spline = spline, .title = "rose", .unit = c.unit};
        std::string unit;
        expect_curve(read_step(file("u.step", cad::step_text(scene)), unit), spline, c.millimetres);
        EXPECT_EQ(unit, c.step);
        expect_curve(read_iges(file("u.igs", cad::iges_text(scene)), unit), spline, c.millimetres);
        EXPECT_EQ(unit, c.iges);
        // and our own reader gives the numbers back as they were
        for (const Spline& back : {cad::parse_step("u.step", cad::step_text(scene)).splines.front(),
                                   cad::parse_iges("u.igs", cad::iges_text(scene)).splines.front()})
            for (Index i = 0; i < spline.control_points().size(); ++i)
                EXPECT_NEAR(back.control_points()(i, 0), spline.control_points()(i, 0), 1e-15);
    }
}

TEST(Cad, equal_splines_give_equal_bytes_and_a_date_when_asked) {
    const Spline spline = rose();
    const Spline other = peaks();
    Scene scene{.spline = spline, .title = "a 'name' <b>", .more = {&other}};
    const std::string step = cad::step_text(scene);
    EXPECT_TRUE(step == cad::step_text(scene));
    EXPECT_TRUE(cad::iges_text(scene) == cad::iges_text(scene));
    EXPECT_EQ(cad::parse_step("x.step", step).splines.size(), 2U);
    EXPECT_EQ(cad::parse_iges("x.igs", cad::iges_text(scene)).splines.size(), 2U);
    scene.date = "2026-01-31T12:00:00";
    EXPECT_TRUE(cad::step_text(scene).find("2026-01-31T12:00:00") != std::string::npos);
    EXPECT_TRUE(cad::iges_text(scene).find("20260131.120000") != std::string::npos);
}

TEST(Cad, what_cannot_be_written_or_read_is_said) {
    const auto message = [](auto work) -> std::string {
        try {
            work();
        } catch (const std::exception& error) {
            return error.what();
        }
        return {};
    };
    const Spline volume(
        {uniform_knots(1, 2, 0, 1), uniform_knots(1, 2, 0, 1), uniform_knots(1, 2, 0, 1)},
        PointSet(8, 3));
    EXPECT_EQ(
        message([&] { cad::step_text({.spline = volume}); }),
        "a CAD file holds curves and surfaces in space, this spline has 3 axes in dimension 3");
    EXPECT_EQ(message([] { cad::parse_step("a.step", "not STEP"); }),
              "a.step: not a STEP file that can be read");
    EXPECT_EQ(message([] { cad::parse_iges("a.igs", "not IGES"); }),
              "a.igs: the file holds no B-spline curve or surface");
    std::string rational = cad::step_text({.spline = rose(), .title = "r"});
    const std::string plain = "B_SPLINE_CURVE_WITH_KNOTS('',";
    const std::size_t at = rational.find(plain);
    ASSERT_NE(at, std::string::npos);
    // the same curve as a rational one, all weights 2 but the first
    const std::size_t end = rational.find(");", at);
    const std::string arguments = rational.substr(at + plain.size(), end - at - plain.size());
    const std::size_t poles_end = arguments.find(')');
    const std::string poles = arguments.substr(0, poles_end + 1);
    const std::string form = arguments.substr(poles_end + 1);
    const std::size_t knots_at = form.find('(');
    std::string weights = "1.";
    for (std::size_t k = 1; k < static_cast<std::size_t>(std::ranges::count(poles, '#')); ++k)
        weights += ",2.";
    const std::string before = form.substr(1, knots_at - 2);
    rational.replace(at, end + 1 - at,
                     "( BOUNDED_CURVE() B_SPLINE_CURVE(" + poles + "," + before +
                         ") B_SPLINE_CURVE_WITH_KNOTS(" + form.substr(knots_at) +
                         ") CURVE() GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_CURVE((" +
                         weights + ")) REPRESENTATION_ITEM('') )");
    EXPECT_EQ(message([&] { cad::parse_step("a.step", rational); }),
              "a.step: the curve is rational (its poles have weights); only plain B-splines are "
              "read");
}

} // namespace
} // namespace batten
