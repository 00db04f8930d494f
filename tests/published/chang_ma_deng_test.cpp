// Chang, Ma, Deng 2023, CLSPIA.
#include "problems.hpp"

#include <batten/iterate/clspia.hpp>
#include <batten/shape/polygon.hpp>
#include <numbers>

namespace batten {
namespace {

using testing::shared;

FitOptions clspia_options(Index n, std::vector<Index> exact) {
    FitOptions options;
    options.shape.control_points = {n};
    options.hold.interpolate = std::move(exact);
    options.method.name = "clspia";
    options.stop = {.max_iterations = 300000, .relative_gradient = 1e-12};
    options.keep_history = false;
    return options;
}

std::vector<Index> every(Index step, Index count) {
    std::vector<Index> list;
    for (Index i = 0; i < count; i += step) list.push_back(i);
    return list;
}

/// The limit [ChangMaDeng2023, eq. 13 and theorem 2]: the other samples approximated best among the
/// splines through the exact ones, from a dense problem of its own.
reference::Matrix dense_limit(const Samples& samples, const FitResult& result,
                              const std::vector<Index>& exact) {
    const std::vector<KnotVector>& axes = result.spline.axes();
    const reference::Matrix all =
        result.parameters.is_scattered()
            ? reference::scattered_collocation(axes, result.parameters.scattered)
            : reference::collocation(axes[0], result.parameters.axes[0]);
    std::vector<Index> others;
    for (Index i = 0; i < samples.size(); ++i)
        if (std::find(exact.begin(), exact.end(), i) == exact.end()) others.push_back(i);
    const reference::Matrix q = reference::matrix(samples.points);
    return reference::least_squares(all(others, Eigen::all), q(others, Eigen::all),
                                    all(exact, Eigen::all), q(exact, Eigen::all));
}

double squared_errors(const FitResult& result, const Samples& samples,
                      const std::vector<Index>& exact) {
    const auto d = reference::deviations(result.spline, samples.points, result.parameters);
    double sum = 0;
    for (Index i : exact) sum += d[static_cast<std::size_t>(i)] * d[static_cast<std::size_t>(i)];
    return sum;
}

void compare_with_the_limit(const Samples& samples, FitOptions options) {
    const FitResult iterated = fit(samples, options);
    EXPECT_EQ(iterated.report.termination, Termination::converged);
    EXPECT_GT(iterated.report.settings.at("outer_iterations"), 1);
    EXPECT_LT(squared_errors(iterated, samples, options.hold.interpolate), 1e-20);
    const reference::Matrix limit = dense_limit(samples, iterated, options.hold.interpolate);
    EXPECT_LT(reference::difference(limit, iterated.spline.control_points()), 1e-9);
    options.method = {.name = "direct"};
    const FitResult direct = fit(samples, options);
    EXPECT_LT(squared_errors(direct, samples, options.hold.interpolate), 1e-24);
    EXPECT_LT(reference::difference(limit, direct.spline.control_points()), 1e-10);
}

TEST(ChangMaDeng, glyph_with_every_50th_sample_exact) {
    BATTEN_NEEDS_SHARED("glyph577.csv");
    compare_with_the_limit(read_points(shared("glyph577.csv")), clspia_options(55, every(50, 577)));
}

TEST(ChangMaDeng, profile_with_every_20th_sample_exact) {
    BATTEN_NEEDS_SHARED("profile205.csv");
    compare_with_the_limit(read_points(shared("profile205.csv")),
                           clspia_options(20, every(20, 205)));
}

TEST(ChangMaDeng, surface_with_60_of_10201_scattered_samples_exact) {
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(0, 1);
    PointSet q(101 * 101, 3);
    PointSet uv(q.size(), 2);
    for (Index i = 0; i < q.size(); ++i) {
        const double u = i < 4 ? static_cast<double>(i % 2)
                               : unit(random); // the corners, so that the domain is the unit square
        const double v = i < 4 ? static_cast<double>(i / 2) : unit(random);
        uv(i, 0) = u;
        uv(i, 1) = v;
        q(i, 0) = u;
        q(i, 1) = v;
        q(i, 2) = 0.3 * std::sin(3 * u) * std::cos(4 * v);
    }
    FitOptions options = clspia_options(13, {});
    for (Index k = 0; k < 60; ++k) { // the samples nearest to a 10 x 6 lattice
        const PointSet place(
            {(static_cast<double>(k % 10) + 0.5) / 10, (static_cast<double>(k / 10) + 0.5) / 6}, 2);
        Index nearest = 0;
        for (Index i = 0; i < uv.size(); ++i)
            if (distance(uv[i], place[0]) < distance(uv[nearest], place[0])) nearest = i;
        options.hold.interpolate.push_back(nearest);
    }
    options.shape.parameters = Parameters{{}, uv};
    compare_with_the_limit(testing::sequence(q), options);
}

TEST(ChangMaDeng, as_many_constraints_as_control_points_leave_nothing_to_approximate) {
    BATTEN_NEEDS_SHARED("glyph577.csv");
    const Samples glyph =
        read_points(shared("glyph577.csv")); // Fig. 9: 35 control points and constraints
    std::vector<Index> exact;
    for (Index i = 0; i < 35; ++i) exact.push_back(i * 576 / 34);
    FitOptions options = clspia_options(35, exact);
    options.method.name = "direct";
    const FitResult before = fit(glyph, options);
    options.shape.parameters = before.parameters;
    // as many equations as unknowns: the curve is the one through the exact samples
    const reference::Matrix through = reference::solve(
        reference::collocation(before.spline.axis(0), before.parameters.axes[0])(exact, Eigen::all),
        reference::matrix(glyph.points)(exact, Eigen::all));
    EXPECT_LT(reference::difference(through, before.spline.control_points()), 1e-9);
    PointSet moved(glyph.points);
    const PointSet noise = testing::random_points(577, 2, 3);
    for (Index i = 0; i < 577; ++i)
        if (std::find(exact.begin(), exact.end(), i) == exact.end())
            for (Index d = 0; d < 2; ++d) moved(i, d) += 0.1 * noise(i, d);
    const FitResult after = fit(testing::sequence(moved), options);
    EXPECT_LT(reference::difference(through, after.spline.control_points()), 1e-9);
}

TEST(ChangMaDeng, ten_thousand_samples_with_40_exact) {
    // Fig. 15 in size; the paper's data are not public, a wavy closed curve stands in
    PointSet q(10001, 2);
    for (Index i = 0; i < q.size(); ++i) {
        const double t = 2 * std::numbers::pi * static_cast<double>(i) / 10000;
        const double r = 1 + 0.2 * std::sin(5 * t) + 0.02 * std::sin(90 * t);
        q(i, 0) = r * std::cos(t);
        q(i, 1) = r * std::sin(t);
    }
    FitOptions options = clspia_options(100, every(250, 10000));
    ASSERT_EQ(options.hold.interpolate.size(), 40U);
    compare_with_the_limit(testing::sequence(q), options);
}

TEST(ChangMaDeng, shape_preserving_fits_never_gain_an_inflection) {
    // a profile with inflections: a bump on a slope, sampled with noise that tempts the fit to
    // wiggle
    PointSet q(200, 2);
    const PointSet noise = testing::random_points(200, 1, 8);
    for (Index i = 0; i < 200; ++i) {
        const double x = static_cast<double>(i) / 199;
        q(i, 0) = x;
        q(i, 1) = 0.4 * std::exp(-40 * (x - 0.5) * (x - 0.5)) + 0.1 * x + 0.003 * noise(i, 0);
    }
    for (const char* method : {"lspia", "mlspia", "clspia"}) {
        FitOptions options;
        options.shape.control_points = {24};
        options.method.name = method;
        if (method == std::string("clspia")) options.hold.interpolate = {0, 199};
        options.stop.max_iterations = 3000;
        options.hold.preserve = Preserve::inflections;
        Index start = -1;
        Index most = 0;
        options.observer = [&](const Iteration& now) {
            const Index count = inflection_count(now.control);
            if (start < 0) start = count;
            most = std::max(most, count);
            return Continue::yes;
        };
        const FitResult kept = fit(testing::sequence(q), options);
        EXPECT_LE(most, start) << method;
        EXPECT_EQ(kept.report.inflections, start) << method;
        // it did move: closer to the samples than the polygon it began with
        EXPECT_LT(kept.report.gradient_norm, 0.5 * kept.report.first_gradient_norm) << method;
        options.hold.preserve = Preserve::nothing;
        start = -1;
        most = 0;
        fit(testing::sequence(q), options);
        EXPECT_GT(most, start) << method; // without the limit inflections do come
    }
}

TEST(Constraints, that_cannot_hold_are_named) {
    const Samples rose = generate("rose", {60});
    const auto refusal = [&](std::vector<Index> exact, Index n, const char* method) {
        FitOptions options = clspia_options(n, std::move(exact));
        options.method.name = method;
        return testing::message_of<InvalidInput>([&] { fit(rose, options); });
    };
    EXPECT_EQ(refusal({0, 60}, 10, "direct"), "interpolated sample 60: the samples are 0 to 59");
    EXPECT_EQ(refusal({3, 7, 3}, 10, "clspia"), "interpolated sample 3 is given twice");
    EXPECT_EQ(refusal({0, 1, 2, 3, 4, 5, 6, 7}, 6, "direct"),
              "8 constraints on 6 control points: at most as many are possible");
    EXPECT_EQ(refusal({0, 59}, 10, "lspia"),
              "method lspia cannot pass through samples exactly; direct, clspia, epia can");
    EXPECT_EQ(
        refusal({0, 1, 2, 3, 4, 50}, 12, "direct"),
        "constraints contradict each other: sample 0, sample 1, sample 2, sample 3, sample 4");
    FitOptions options;
    options.shape.control_points = {8};
    options.hold.preserve = Preserve::convexity;
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(generate("helix"), options); }),
              "preserve: shape is kept for curves in the plane, not for a curve in dimension 3");
    PointSet wave(60, 2);
    for (Index i = 0; i < 60; ++i) {
        wave(i, 0) = static_cast<double>(i) / 10;
        wave(i, 1) = std::sin(wave(i, 0));
    }
    EXPECT_EQ(testing::message_of<InvalidInput>([&] { fit(testing::sequence(wave), options); }),
              "preserve convexity: the initial control polygon is not convex");
}

TEST(Constraints, derivatives_and_points_hold_exactly_at_any_offset) {
    const Samples rose = generate("rose");
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    const std::vector<KnotVector> axes{knots_from_parameters(t.axes[0], 3, 40)};
    const auto system = assemble(axes, rose, t);
    Constraints c(2);
    c.add(axes, std::array{0.0}, std::array{1}, std::array{3.0, -1.0}, "tangent at the start");
    c.add(axes, std::array{0.4}, {}, std::array{0.1, 0.2}, "a point");
    const PointSet p =
        uncentred(solve_direct(*system, c.centred(system->centre())), system->centre());
    const Spline s = Spline::from_free(axes, p);
    const auto slope = reference::point(s, {0.0}, {1});
    EXPECT_NEAR(static_cast<double>(slope(0)), 3, 1e-12);
    EXPECT_NEAR(static_cast<double>(slope(1)), -1, 1e-12);
    EXPECT_NEAR(static_cast<double>(reference::point(s, {0.4})(0)), 0.1, 1e-14);
    EXPECT_NEAR(static_cast<double>(reference::point(s, {0.4})(1)), 0.2, 1e-14);
}

} // namespace
} // namespace batten
