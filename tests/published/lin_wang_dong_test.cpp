// Lin, Wang, Dong 2004, PIA. The paper's helix and peaks data are not given to the digit; the
// errors expected here are of the same formulas computed independently, the paper's Table 1 stands
// beside them.
#include "lin_wang_dong_data.hpp"
#include "problems.hpp"

#include <batten/shape/polygon.hpp>

namespace batten {
namespace {

/// Largest deviation after 0, 2, 4, 15 and 30 steps.
std::vector<double> errors(const Samples& samples) {
    FitOptions options;
    options.method.name = "pia";
    options.stop = {.max_iterations = 30, .relative_gradient = 0};
    options.keep_history = true;
    const FitResult result = fit(samples, options);
    std::vector<double> kept;
    for (std::size_t k : {0U, 2U, 4U, 15U, 30U})
        kept.push_back(result.report.history.at(k).max_deviation);
    return kept;
}

TEST(LinWangDong, helix_of_20_points) {
    const double expected[] = {1.9600035545, 0.30703252999, 0.068938778514, 2.2082744728e-4,
                               2.6628015e-7}; // paper, 4 digits at step 0: 1.9603
    const auto found = errors(command::paper_helix());
    for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(found[k] / expected[k], 1, k < 4 ? 1e-9 : 1e-7);
}

TEST(LinWangDong, peaks_surface_30_x_30) {
    const double expected[] = {0.41452893083, 0.10532418316, 0.041022801923, 5.3318778318e-4,
                               3.2047377e-5};
    const auto found = errors(generate("peaks", {30, 30}));
    for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(found[k] / expected[k], 1, 1e-7);
}

TEST(LinWangDong, the_limit_interpolates_and_local_pia_interpolates_its_part) {
    const Samples rose = generate("rose", {40});
    FitOptions options;
    options.method.name = "pia";
    const FitResult all = fit(rose, options);
    const auto deviations = [&](const FitResult& result) {
        return reference::deviations(result.spline, rose.points, result.parameters);
    };
    EXPECT_LT(reference::largest(deviations(all)), 1e-8);
    // each step leaves 1 - B of the errors at the samples: B is A on the control points that follow
    // samples, the first and the last of which are doubled at the ends
    const reference::Matrix a = reference::collocation(all.spline.axis(0), all.parameters.axes[0]);
    const Index m = a.rows();
    reference::Matrix b = a.middleCols(1, m);
    b.col(0) += a.col(0);
    b.col(m - 1) += a.col(m + 1);
    const double radius = reference::spectral_radius(reference::Matrix::Identity(m, m) - b);
    EXPECT_NEAR(all.report.observed_rate, radius, 2e-2);
    EXPECT_NEAR(all.report.predicted_rate, radius,
                2e-2); // power iteration on a matrix that is not symmetric
    options.method.moving = {11, 12, 13, 14, 15}; // the control points of samples 10 to 14
    const FitResult part = fit(rose, options);
    const auto d = deviations(part);
    for (std::size_t j = 10; j < 15; ++j) EXPECT_LT(d[j], 1e-8);
    EXPECT_GT(d[20], 1e-4);
}

TEST(LinWangDong, any_square_collocation_and_any_weight) {
    const Samples rose = generate("rose", {30});
    for (int degree : {1, 2, 3, 4}) {
        FitOptions options;
        options.method.name = "pia";
        options.shape.degree = {degree};
        options.shape.control_points = {30};
        options.method.settings = {{"weight", 1.2}};
        options.stop.max_iterations = 100000;
        const FitResult result = fit(rose, options);
        EXPECT_LT(reference::largest(
                      reference::deviations(result.spline, rose.points, result.parameters)),
                  1e-7)
            << degree;
    }
    FitOptions options;
    options.method.name = "pia";
    options.shape.control_points = {20};
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(rose, options); }),
              "axis 0: pia needs as many control points as samples, got 20 and 30");
}

TEST(LinWangDong, convexity_preserving_pia_keeps_every_turn) {
    int lost = 0;
    int locked = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const Samples q = command::convex_polygon(seed);
        FitOptions options;
        options.method.name = "pia";
        options.stop = {.max_iterations = 30, .relative_gradient = 0};
        const std::vector<int> wanted = turn_signs(PointSet(q.points));
        bool plain_lost = false;
        options.observer = [&](const Iteration& now) {
            plain_lost = plain_lost || turn_signs(now.control) != wanted;
            return Continue::yes;
        };
        fit(q, options);
        if (!plain_lost) continue;
        ++lost;
        options.hold.preserve = Preserve::convexity;
        options.stop.max_iterations = 500;
        options.keep_history = true;
        Index broken = 0;
        options.observer = [&](const Iteration& now) {
            broken += turn_signs(now.control) != wanted ? 1 : 0;
            return Continue::yes;
        };
        const FitResult kept = fit(q, options);
        EXPECT_EQ(broken, 0) << seed;
        const auto& history = kept.report.history;
        EXPECT_LT(history.back().gradient_norm, history.front().gradient_norm);
        for (std::size_t k = 1; k < history.size(); ++k)
            EXPECT_LE(history[k].gradient_norm, history[k - 1].gradient_norm * (1 + 1e-12))
                << seed << " step " << k;
        if (kept.report.termination == Termination::stalled) ++locked;
    }
    EXPECT_GT(lost, 15); // about half of random polygons
    EXPECT_GT(locked, 0);
}

} // namespace
} // namespace batten
