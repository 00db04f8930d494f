#include <batten/basis/place_knots.hpp>
#include <batten/search/curve_corners.hpp>
#include <batten/search/curve_direction.hpp>
#include <batten/search/curve_missed.hpp>
#include <batten/search/residual_noise.hpp>
#include <batten/search/verdict_words.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

namespace batten {
namespace {

/// A wave of `count` samples, with noise of one standard deviation across it.
PointSet wave(Index count, double noise) {
    std::mt19937_64 engine(4);
    std::normal_distribution<double> normal(0, 1);
    PointSet points(count, 2);
    for (Index i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count - 1);
        points(i, 0) = 10 * t;
        points(i, 1) = std::sin(6 * t) + noise * normal(engine);
    }
    return points;
}

TEST(ResidualNoise, is_that_of_the_samples) {
    for (const double noise : {0.001, 0.02, 0.3})
        EXPECT_NEAR(residual_noise(wave(500, noise)) / noise, 1, 0.15);
}

TEST(ResidualNoise, is_unknown_where_only_the_shape_is_seen) {
    EXPECT_EQ(residual_noise(wave(33, 0)), 0);
    EXPECT_EQ(residual_noise(wave(10, 0.1)), 0); // too few to tell
    PointSet walk = wave(600, 0.1);              // steps of chance: what is left has a course
    for (Index i = 1; i < walk.size(); ++i) walk(i, 1) += walk(i - 1, 1);
    EXPECT_EQ(residual_noise(walk), 0);
}

TEST(ResidualNoise, follows_the_unit) {
    PointSet points = wave(200, 0.02);
    const double noise = residual_noise(points);
    for (double& x : points.values()) x = std::ldexp(x, 40);
    EXPECT_EQ(residual_noise(points), std::ldexp(noise, 40));
}

/// A sequence of the wave's samples with its parameters over [0, 1].
CurveTask task_over(const Samples& samples, int degree, Closure closure) {
    CurveTask task{.samples = samples,
                   .tolerance = std::vector<double>(static_cast<std::size_t>(samples.size()), 1),
                   .degree = degree,
                   .closure = closure};
    task.parameters = parametrize_sequence(samples.points, Parametrization::chord, closure);
    return task;
}

TEST(KnotsThrough, are_as_many_as_the_samples_and_determined_by_them) {
    const Samples samples{.points = wave(24, 0.3)};
    for (const Closure closure : {Closure::open, Closure::closed})
        for (int degree = 1; degree <= 9; ++degree)
            for (Index corner = -1; corner < samples.size(); ++corner)
                for (int seam = 0; seam < degree; ++seam) {
                    CurveTask task = task_over(samples, degree, closure);
                    task.seam_continuity = seam;
                    const bool end =
                        closure == Closure::open && (corner == 0 || corner + 1 == samples.size());
                    if (corner >= 0 && !end) task.corners = spaced_corners({corner}, task);
                    const auto knots = knots_through(task);
                    const std::string where =
                        fmt::format("degree {}, {}, corner {}, seam C{}", degree,
                                    closure == Closure::open ? "open" : "closed", corner, seam);
                    // a held seam beside a corner leaves too few samples to a piece between them
                    const bool crowded = closure == Closure::closed && seam < degree - 1 &&
                                         !task.corners.empty() && corner != 0 &&
                                         std::min(corner, samples.size() - corner) <= degree;
                    if (!knots) {
                        EXPECT_TRUE(crowded) << where;
                        continue;
                    }
                    EXPECT_EQ(knots->free_count(), samples.size()) << where;
                    EXPECT_FALSE(undetermined(*knots, task.parameters)) << where;
                }
}

TEST(KnotsThrough, do_without_a_held_seam_that_is_no_sample) {
    const Samples samples{.points = wave(24, 0)};
    CurveTask task = task_over(samples, 3, Closure::closed);
    for (double& t : task.parameters) t = 0.1 + 0.8 * t;
    task.seam_continuity = 0;
    EXPECT_FALSE(knots_through(task));
}

TEST(ResidualNoise, takes_samples_that_lie_together) {
    PointSet points = wave(600, 0);
    for (Index i = 200; i < 400; ++i)
        for (Index d = 0; d < 2; ++d)
            points(i, d) = points(200, d) + 1e-19 * static_cast<double>(i);
    EXPECT_NO_THROW(residual_noise(points));
}

TEST(Direction, one_of_a_sequence_and_its_reverse_runs_backwards) {
    const Samples samples{.points = wave(40, 0.05)};
    for (const Closure closure : {Closure::open, Closure::closed}) {
        const Turned turned(samples.size(), closure);
        const Samples other = turned(samples);
        EXPECT_NE(runs_backwards(samples.points, closure), runs_backwards(other.points, closure));
        const Samples back = turned(other);
        for (Index i = 0; i < samples.size(); ++i)
            EXPECT_EQ(distance(back.points[i], samples.points[i]), 0);
    }
}

TEST(Direction, a_turned_curve_is_the_same_curve) {
    for (const Closure closure : {Closure::open, Closure::closed}) {
        CurveTrial trial;
        trial.knots = knots_around(3, std::vector{0.1, 0.3, 0.35, 0.6, 0.9}, 0, 1, closure);
        trial.control = wave(trial.knots.free_count(), 1);
        trial.parameters = {0, 0.2, 0.5, 0.7};
        trial.ratio = trial.weights = {1, 2, 3, 4};
        const CurveTrial other = Turned(4, closure)(trial);
        const Spline curve = spline_of(trial);
        const Spline reverse = spline_of(other);
        for (const double t : {0.0, 0.05, 0.2, 0.42, 0.77, 1.0})
            EXPECT_LT(distance(curve(std::array{t}), reverse(std::array{1 - t})), 1e-13);
    }
}

TEST(Verdict, says_what_is_handed_out) {
    EXPECT_EQ(not_met_words(
                  {.why = NotMet::limited, .allowed = 20, .control_points = 18, .deviation = 0.25}),
              "not met: 20 control points are allowed and do not suffice; the closest smooth fit "
              "found: 18 control points, largest deviation 0.25");
    EXPECT_NE(near_interpolation_words(30, 40, 0, 1).find("unknown"), std::string::npos);
    EXPECT_EQ(near_interpolation_words(20, 40, 0, 1), "");
}

} // namespace
} // namespace batten
