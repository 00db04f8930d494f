#include "problems.hpp"

#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/mlspia.hpp>

#include <limits>

namespace batten {
namespace {

using testing::largest_difference;
using testing::message_of;

std::unique_ptr<NormalSystem> rose_system(const Samples& rose, Index n) {
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    return assemble({knots_from_parameters(t.axes[0], 3, n)}, rose, t);
}

/// A rose far from the origin, so that absolute and relative control points differ.
Samples far_rose() {
    PointSet points(generate("rose").points);
    for (Index i = 0; i < points.size(); ++i) {
        points(i, 0) += 100;
        points(i, 1) -= 300;
    }
    return testing::sequence(std::move(points));
}

TEST(StopRule, values_that_are_no_stops_are_refused) {
    const Samples rose = generate("rose");
    const auto system = rose_system(rose, 30);
    const auto refusal = [&](const StopRule& stop) {
        Mlspia method(*system);
        PointSet control(30, 2);
        return message_of<InvalidInput>([&] { iterate(method, control, stop); });
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(refusal({.max_iterations = -1}),
              "stop rule: max_iterations = -1 must be a finite number, 0 or more");
    EXPECT_EQ(refusal({.gradient = -0.5}),
              "stop rule: gradient = -0.5 must be a finite number, 0 or more");
    EXPECT_EQ(refusal({.relative_gradient = nan}),
              "stop rule: relative_gradient = nan must be a finite number, 0 or more");
    EXPECT_EQ(refusal({.deviation = infinite}),
              "stop rule: deviation = inf must be a finite number, 0 or more");
    EXPECT_EQ(refusal({.deviation = 0.1}),
              "stop rule: a deviation is stated, but nothing measures it");
}

TEST(StopRule, the_summary_says_which_test_held) {
    const Samples rose = generate("rose");
    const auto system = rose_system(rose, 30);
    const auto run = [&](const StopRule& stop) {
        ConjugateGradients method(*system);
        PointSet control(30, 2);
        return iterate(method, control, stop, {.deviation = [](const PointSet& at) {
                           return largest_length(at) > 0.5 ? 0.25 : 1.0; // as if measured
                       }});
    };
    const Summary wide = run({.gradient = 1e300, .relative_gradient = 0, .deviation = 0.1});
    EXPECT_EQ(wide.termination, Termination::converged);
    EXPECT_EQ(wide.iterations, 0);
    EXPECT_TRUE(wide.held.gradient);
    EXPECT_FALSE(wide.held.relative_gradient);
    EXPECT_FALSE(wide.held.deviation); // stated, not reached, and visible
    EXPECT_EQ(wide.deviation, 1.0);

    const Summary close = run({.relative_gradient = 0, .deviation = 0.3});
    EXPECT_EQ(close.termination, Termination::converged);
    EXPECT_FALSE(close.held.gradient || close.held.relative_gradient);
    EXPECT_TRUE(close.held.deviation);
    EXPECT_EQ(close.deviation, 0.25);

    const Summary relative = run({.relative_gradient = 1e-6});
    EXPECT_TRUE(relative.held.relative_gradient);
    EXPECT_FALSE(relative.deviation.has_value()); // nobody asked
    EXPECT_LE(relative.gradient_norm, 1e-6 * relative.reference_norm);
    EXPECT_EQ(relative.reference_norm, relative.first_gradient_norm);

    const Summary spent = run({.max_iterations = 2, .relative_gradient = 0, .deviation = 0.1});
    EXPECT_EQ(spent.termination, Termination::iteration_limit);
    EXPECT_FALSE(spent.held.any());
}

TEST(Observers, see_absolute_control_points) {
    const Samples rose = far_rose();
    const auto system = rose_system(rose, 30);
    const PointSet start = testing::random_points(30, 2, 4);
    PointSet control = start;
    std::vector<PointSet> seen;
    std::vector<PointSet> measured;
    IterateHooks hooks;
    hooks.observer = [&](const Iteration& now) {
        seen.push_back(now.control);
        return Continue::yes;
    };
    hooks.deviation = [&](const PointSet& at) {
        measured.push_back(at);
        return 1.0;
    };
    hooks.centre = system->centre();
    Mlspia method(*system);
    iterate(method, control, {.max_iterations = 3, .deviation = 0.5}, hooks);
    ASSERT_EQ(seen.size(), 4U);
    EXPECT_LT(largest_difference(seen.front(), uncentred(start, system->centre())), 1e-12);
    EXPECT_LT(largest_difference(seen.back(), uncentred(control, system->centre())), 1e-12);
    EXPECT_EQ(measured.back().values(), seen.back().values());
}

TEST(Observers, and_frames_see_the_fit_itself_whatever_the_method) {
    const Samples rose = far_rose();
    for (const char* name : {"lspia", "mlspia", "cg", "pia", "epia", "clspia"}) {
        FitOptions options;
        options.method.name = name;
        const bool pia = name == std::string("pia");
        if (name == std::string("clspia")) options.hold.interpolate = {0, 250};
        if (!pia) options.shape.control_points = {30};
        options.most_frames = 1000;
        options.keep_history = true;
        options.stop = {.max_iterations = 12, .relative_gradient = 0};
        PointSet last;
        options.observer = [&](const Iteration& now) {
            last = now.control;
            return Continue::yes;
        };
        const FitResult result = fit(rose, options);
        EXPECT_LT(largest_difference(last, result.spline.free_control_points()), 1e-10) << name;
        if (name != std::string("epia")) { // which keeps none
            ASSERT_FALSE(result.report.frames.empty()) << name;
            EXPECT_LT(largest_difference(result.report.frames.back().control, last), 1e-10) << name;
        }
        EXPECT_NEAR(result.report.history.back().max_deviation, result.report.deviation.maximum,
                    1e-10)
            << name;
    }
}

} // namespace
} // namespace batten
