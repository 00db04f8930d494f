// The library's own readers and writers know STEP and IGES once they were told.
#include "test_folder.hpp"

#include <batten/cad/cad.hpp>
#include <batten/fit/fit.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/samples/generate.hpp>

#include <algorithm>
#include <gtest/gtest.h>
#include <thread>

namespace batten {
namespace {

Spline rose() {
    return fit(generate("rose"), {.shape = {.control_points = {30}}}).spline;
}

std::string message(const std::filesystem::path& path) {
    try {
        read_spline(path);
    } catch (const FileError& error) {
        return error.what();
    } catch (const InvalidInput& error) {
        return std::string("input: ") + error.what();
    }
    return {};
}

double apart(const Spline& a, const Spline& b) {
    double largest = a.control_points().size() == b.control_points().size() ? 0 : 1e300;
    for (Index i = 0; largest < 1e300 && i < a.control_points().size(); ++i)
        for (Index d = 0; d < a.dim(); ++d)
            largest =
                std::max(largest, std::abs(a.control_points()(i, d) - b.control_points()(i, d)));
    return largest;
}

TEST(CadFormats, are_registered_once) {
    cad::register_formats();
    cad::register_formats();
    for (const char* extension : {".step", ".stp", ".igs", ".iges"})
        EXPECT_EQ(std::ranges::count(spline_formats(), extension, &SplineFormat::extension), 1);
}

TEST(CadFormats, splines_come_back_in_many_threads) {
    cad::register_formats();
    const Spline spline = rose();
    std::vector<double> errors(6, 1);
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < errors.size(); ++k)
        threads.emplace_back([&, k] {
            const auto path =
                in_test_folder("rose" + std::to_string(k) + (k % 2 == 0 ? ".step" : ".iges"));
            write_spline(path, {.spline = spline});
            errors[k] = apart(spline, read_spline(path));
        });
    for (std::thread& thread : threads) thread.join();
    for (double error : errors) EXPECT_LT(error, 1e-13);
}

TEST(CadFormats, a_crash_of_open_cascade_is_a_line) {
    cad::register_formats();
    const auto path = in_test_folder("dangling.step");
    write_spline(path, {.spline = rose()});
    std::string text = read_file(path);
    const std::string reference = "B_SPLINE_CURVE_WITH_KNOTS('',3,(#";
    const std::size_t at = text.find(reference);
    ASSERT_NE(at, std::string::npos);
    text.insert(at + reference.size(), "9999"); // a pole that is not there
    write_file(path, text);
    EXPECT_TRUE(
        message(path).starts_with(path.string() + ": Open CASCADE failed while reading it ("))
        << message(path); // signal 11, where no sanitizer turns it into a status
}

TEST(CadFormats, options_are_heeded) {
    const auto path = in_test_folder("asked.step");
    cad::register_formats();
    write_spline(path, {.spline = rose()});
    cad::register_formats({.cancelled = [] { return true; }});
    EXPECT_THROW(read_spline(path), Cancelled);
    EXPECT_THROW(write_spline(path, {.spline = rose()}), Cancelled);
    cad::register_formats({.program = "/none/batten-cad"});
    EXPECT_TRUE(message(path).starts_with(
        "input: STEP and IGES need the program batten-cad, which was not built (cmake "
        "-DBATTEN_CAD=ON) or not installed: there is no /none/batten-cad, no "))
        << message(path);
    cad::register_formats();
    EXPECT_EQ(message(path), "");
}

} // namespace
} // namespace batten
