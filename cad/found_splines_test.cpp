// What Open CASCADE trims or puts beside splines, written by it, read back as the part or with a
// line that says what was left out.
#include "cad_formats.hpp"
#include "geometry.hpp"
#include "test_folder.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/io/output_file.hpp>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <gp_Ax2d.hxx>
#include <gp_Pln.hxx>
#include <gtest/gtest.h>
#include <random>

namespace batten::cad {
namespace {

Spline wavy(std::vector<KnotVector> axes) {
    Index count = 1;
    for (const KnotVector& axis : axes) count *= axis.control_count();
    PointSet control(count, 3);
    std::mt19937 random(3);
    for (Index i = 0; i < count; ++i)
        for (Index d = 0; d < 3; ++d)
            control(i, d) = std::uniform_real_distribution<double>(0, 10)(random);
    return {std::move(axes), std::move(control)};
}

SplineFile as_step(const std::vector<TopoDS_Shape>& shapes) {
    STEPControl_Writer writer;
    for (const TopoDS_Shape& shape : shapes) writer.Transfer(shape, STEPControl_AsIs);
    const auto path = in_test_folder("found.step");
    EXPECT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
    return parse_step(path, read_file(path));
}

SplineFile as_iges(const std::vector<TopoDS_Shape>& shapes) {
    IGESControl_Writer writer("MM", 1); // faces as trimmed surfaces
    for (const TopoDS_Shape& shape : shapes) writer.AddShape(shape);
    writer.ComputeModel();
    const auto path = in_test_folder("found.igs");
    EXPECT_TRUE(writer.Write(path.c_str()));
    return parse_iges(path, read_file(path));
}

TEST(FoundSplines, a_trimmed_curve_is_its_part) {
    const Spline spline = wavy({uniform_knots(3, 9, 0, 1)});
    double first = 0;
    double last = 0;
    const auto curve = BRep_Tool::Curve(TopoDS::Edge(shape_of(spline)), first, last);
    const TopoDS_Shape edge = BRepBuilderAPI_MakeEdge(curve, 0.23, 0.71).Edge();
    for (const SplineFile& file : {as_step({edge}), as_iges({edge})}) {
        ASSERT_EQ(file.splines.size(), 1U);
        EXPECT_TRUE(file.notes.empty());
        const Spline& part = file.splines[0];
        EXPECT_NEAR(part.axis(0).begin(), 0.23, 1e-9);
        EXPECT_NEAR(part.axis(0).end(), 0.71, 1e-9);
        for (double t = 0.24; t < 0.7; t += 0.05) {
            const auto whole = spline(std::array{t});
            const auto found = part(std::array{t});
            for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(found[d], whole[d], 1e-7);
        }
    }
}

TEST(FoundSplines, a_face_trimmed_to_a_rectangle_is_its_part) {
    const Spline spline = wavy({uniform_knots(3, 7, 0, 1), uniform_knots(2, 6, 0, 2)});
    const auto surface = BRep_Tool::Surface(TopoDS::Face(shape_of(spline)));
    const TopoDS_Shape face = BRepBuilderAPI_MakeFace(surface, 0.3, 0.8, 0.5, 2, 1e-7).Face();
    for (const SplineFile& file : {as_step({face}), as_iges({face})}) {
        ASSERT_EQ(file.splines.size(), 1U);
        EXPECT_TRUE(file.notes.empty());
        const Spline& part = file.splines[0];
        EXPECT_NEAR(part.axis(0).begin(), 0.3, 1e-7);
        EXPECT_NEAR(part.axis(0).end(), 0.8, 1e-7);
        EXPECT_NEAR(part.axis(1).begin(), 0.5, 1e-7);
        EXPECT_NEAR(part.axis(1).end(), 2, 1e-7);
        const auto whole = spline(std::array{0.4, 1.3});
        const auto found = part(std::array{0.4, 1.3});
        for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(found[d], whole[d], 1e-7);
    }
}

TEST(FoundSplines, other_trims_and_other_faces_are_named) {
    const Spline spline = wavy({uniform_knots(3, 7, 0, 1), uniform_knots(3, 6, 0, 1)});
    const auto surface = BRep_Tool::Surface(TopoDS::Face(shape_of(spline)));
    const Handle(Geom2d_Circle) circle =
        new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(0.5, 0.5), gp_Dir2d(1, 0)), 0.3);
    TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(circle, surface).Edge();
    BRepLib::BuildCurve3d(edge);
    const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(edge).Wire();
    const TopoDS_Shape disc = BRepBuilderAPI_MakeFace(surface, wire).Face();
    const TopoDS_Shape plane = BRepBuilderAPI_MakeFace(gp_Pln(), 0, 1, 0, 1).Face();
    for (const SplineFile& file : {as_step({disc, plane}), as_iges({disc, plane})}) {
        ASSERT_EQ(file.splines.size(), 1U);
        EXPECT_NEAR(file.splines[0].axis(0).length(), 1, 1e-12);
        ASSERT_EQ(file.notes.size(), 2U);
        EXPECT_EQ(file.notes[0],
                  "1 of its faces is trimmed along curves: read whole, without the trims");
        EXPECT_EQ(file.notes[1], "1 of its faces and edges is no B-spline: left out");
    }
}

TEST(FoundSplines, units_of_every_name_leave_the_coordinates) {
    const Spline spline = wavy({uniform_knots(3, 5, 0, 1)});
    const std::string text = step_text({.spline = spline, .title = "u"});
    const std::string millimetre = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )";
    const auto with = [&](const std::string& unit, const std::string& more) {
        std::string other = text;
        other.replace(other.find(millimetre), millimetre.size(), unit);
        const std::string end = "ENDSEC;\nEND-ISO";
        return other.insert(other.rfind(end), more);
    };
    const auto converted = [&](const std::string& name, const std::string& size) {
        return with("( CONVERSION_BASED_UNIT('" + name + "',#901) LENGTH_UNIT() NAMED_UNIT(#900) )",
                    "#900 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
                    "#901 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(" +
                        size + "),#902);\n#902 = " + millimetre + ";\n");
    };
    std::vector<std::string> files{converted("FOOT", "304.8"), converted("FATHOM", "1828.8"),
                                   converted("ell", "1143.")};
    for (const char* prefix : {"KILO", "DECI", "CENTI", "MICRO", "NANO"})
        files.push_back(with(
            "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(." + std::string(prefix) + ".,.METRE.) )", ""));
    for (const std::string& file : files) {
        ASSERT_NE(file, text);
        const SplineFile back = parse_step("u.step", file);
        ASSERT_EQ(back.splines.size(), 1U);
        for (Index i = 0; i < 5; ++i)
            for (Index d = 0; d < 3; ++d)
                EXPECT_NEAR(back.splines[0].control_points()(i, d), spline.control_points()(i, d),
                            1e-14);
    }
}

} // namespace
} // namespace batten::cad
