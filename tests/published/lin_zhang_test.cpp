// Lin, Zhang 2011, EPIA. The paper's glyph is not public: glyph273.csv is nearly it, with raw
// corners.
#include "problems.hpp"

namespace batten {
namespace {

using testing::shared;

/// Largest distance of a sample from the curve's point at its own parameter.
double largest_deviation(const FitResult& result, const Samples& samples) {
    return reference::largest(
        reference::deviations(result.spline, samples.points, result.parameters));
}

FitOptions epia(double deviation, double eta) {
    FitOptions options;
    options.method.name = "epia";
    options.method.settings = {{"eta", eta}};
    options.stop = {.max_iterations = 100, .relative_gradient = 0, .deviation = deviation};
    options.keep_history = true;
    return options;
}

TEST(LinZhang, glyph_to_0_0035) {
    BATTEN_NEEDS_SHARED("glyph273.csv");
    const Samples glyph = read_points(shared("glyph273.csv"));
    for (const auto& [eta, most] : {std::pair{0.6, 90}, std::pair{0.9, 110}}) {
        FitOptions options = epia(0.0035, eta);
        options.stop.max_iterations = 120;
        const FitResult result = fit(glyph, options);
        EXPECT_EQ(result.report.termination, Termination::tolerance_met) << eta;
        EXPECT_LE(largest_deviation(result, glyph), 0.0035 * (1 + 1e-12)) << eta;
        EXPECT_LE(result.report.control_shape[0], most) << eta;
        EXPECT_EQ(result.report.history.size(),
                  static_cast<std::size_t>(result.report.iterations) + 1);
    }
    FitOptions exact = epia(0.0035, 0.6);
    exact.method.settings["exact"] = 1;
    exact.stop.max_iterations = 300;
    const FitResult refined = fit(glyph, exact);
    EXPECT_EQ(refined.report.termination, Termination::tolerance_met);
    EXPECT_LE(largest_deviation(refined, glyph), 0.0035 * (1 + 1e-12));
}

TEST(LinZhang, a_chosen_sample_is_interpolated) {
    BATTEN_NEEDS_SHARED("profile205.csv");
    const Samples profile = read_points(shared("profile205.csv"));
    FitOptions options = epia(0, 0);
    options.shape.control_points = {13}; // the paper's number
    options.method.settings["rounds"] = 0;
    options.hold.interpolate = {60};
    options.stop.max_iterations = 0;
    const FitResult before = fit(profile, options);
    options.stop.max_iterations = 10;
    const FitResult after = fit(profile, options);
    EXPECT_EQ(before.report.control_shape, after.report.control_shape);
    const auto missed = [&](const FitResult& result) {
        return reference::deviations(result.spline, profile.points, result.parameters)[60];
    };
    EXPECT_GT(missed(after), 0);
    EXPECT_GT(missed(before), 10 * missed(after)); // paper: 0.1265 to 0.0097
    EXPECT_NEAR(before.report.constraint_error, missed(before), 1e-12);
    EXPECT_NEAR(after.report.constraint_error, missed(after), 1e-12);
}

TEST(LinZhang, patch_of_peaks_improves_twentyfold_in_100_iterations) {
    FitOptions options = epia(0.01, 0.6);
    const Samples peaks = generate("peaks", {121, 161});
    const FitResult result = fit(peaks, options);
    EXPECT_LE(result.report.control_shape[0], 68);
    EXPECT_LE(result.report.control_shape[1], 90);
    EXPECT_LE(result.report.iterations, 100);
    EXPECT_EQ(result.report.termination, Termination::tolerance_met);
    const double last = largest_deviation(result, peaks);
    EXPECT_NEAR(result.report.history.back().max_deviation, last, 1e-12);
    EXPECT_GT(result.report.history.front().max_deviation,
              20 * last); // paper: 0.053347 to 0.002576
}

TEST(LinZhang, a_cloud_with_parameters_converges) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    PointSet q(3000, 3);
    PointSet uv(3000, 2);
    for (Index i = 0; i < 3000; ++i) {
        uv(i, 0) = q(i, 0) = unit(random);
        uv(i, 1) = q(i, 1) = unit(random);
        q(i, 2) = std::sin(4 * q(i, 0)) * q(i, 1);
    }
    FitOptions options;
    options.method.name = "epia";
    options.shape.control_points = {10, 9};
    options.shape.parameters = Parameters{{}, uv};
    options.stop = {.max_iterations = 3000, .relative_gradient = 1e-8};
    const FitResult result = fit(testing::sequence(q), options);
    EXPECT_EQ(result.report.termination, Termination::converged);
    EXPECT_LT(largest_deviation(result, testing::sequence(q)), 5e-3);
}

TEST(LinZhang, refusals) {
    const Samples rose = generate("rose");
    FitOptions options = epia(0, 0.6);
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(rose, options); }),
              "epia: state where to stop: a stop deviation, a tolerance or a number of "
              "control points");
    Samples corner; // five samples in the place of four control points
    corner.points = Points(PointSet({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1}, 2));
    options.shape.parameters = Parameters{{}, PointSet(corner.points)};
    options.shape.control_points = {4, 4};
    options.hold.interpolate = {0, 1, 2, 3, 4};
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(corner, options); }),
              "epia: setting eta is for sequences and grids, a cloud has no curvature to start "
              "from");
    options.method.settings.clear();
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(corner, options); }),
              "sample 4 finds no control point of its own to be interpolated by: more control "
              "points are needed");
}

} // namespace
} // namespace batten
