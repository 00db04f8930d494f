#include "problems.hpp"

#include <batten/measure/between_samples.hpp>
#include <batten/measure/inflections.hpp>

#include <numbers>

namespace batten {
namespace {

using std::numbers::pi;

/// Points (x, f(x)) for x from 0 to `end`.
PointSet graph(double end, Index count, const std::function<double(double)>& f) {
    PointSet points(count, 2);
    for (Index i = 0; i < count; ++i) {
        const double x = end * static_cast<double>(i) / static_cast<double>(count - 1);
        points(i, 0) = x;
        points(i, 1) = f(x);
    }
    return points;
}

TEST(Inflections, a_wave_shows_one_per_half_wave_while_it_is_high_enough) {
    // sin over three periods bends six times one way or the other: five inflections; each half-wave
    // is 1 high
    const PointSet wave = graph(6 * pi, 601, [](double x) { return std::sin(x); });
    EXPECT_EQ(visible_inflections(wave, 1e-3, Closure::open), 5);
    EXPECT_EQ(visible_inflections(wave, 0.9, Closure::open), 5);
    EXPECT_EQ(visible_inflections(wave, 5.0, Closure::open), 0);
}

TEST(Inflections, noise_below_the_height_does_not_count) {
    PointSet arc = graph(2, 400, [](double x) { return x * x; });
    const PointSet noise = testing::random_points(400, 1, 5);
    for (Index i = 0; i < arc.size(); ++i) arc(i, 1) += 1e-3 * noise(i, 0);
    EXPECT_GT(visible_inflections(arc, 1e-5, Closure::open), 100);
    EXPECT_EQ(visible_inflections(arc, 4e-3, Closure::open), 0);
}

TEST(Inflections, a_closed_line_has_an_even_number) {
    const auto flower = [](double petals, double depth) {
        PointSet points(720, 2);
        for (Index i = 0; i < 720; ++i) {
            const double a = 2 * pi * static_cast<double>(i) / 720;
            const double r = 1 + depth * std::cos(petals * a);
            points(i, 0) = r * std::cos(a);
            points(i, 1) = r * std::sin(a);
        }
        return points;
    };
    EXPECT_EQ(visible_inflections(flower(1, 0), 1e-6, Closure::closed), 0);
    EXPECT_EQ(visible_inflections(flower(3, 0.3), 1e-6, Closure::closed), 6);
    // the curvature of r = 1 + d cos(5 a) keeps its sign while d < 1 / (1 + 25)
    EXPECT_EQ(visible_inflections(flower(5, 0.037), 1e-9, Closure::closed), 0);
    EXPECT_EQ(visible_inflections(flower(5, 0.06), 1e-9, Closure::closed), 10);
    // at 0.06 the hollows are about 0.002 deep
    EXPECT_EQ(visible_inflections(flower(5, 0.06), 0.02, Closure::closed), 0);
}

TEST(Between, a_loop_between_two_samples_is_found) {
    const PointSet loop({0, 0, 3, 1, -2, 1, 1, 0}, 2); // one cubic piece that crosses itself
    const Spline curve({KnotVector(3, {0, 0, 0, 0, 1, 1, 1, 1})}, loop);
    const PointSet samples({0, 0, 1, 0}, 2);
    const BetweenSamples found = check_between(curve, samples, {0, 1}, {0.5, 0.5});
    EXPECT_EQ(found.loops, 1);
    EXPECT_FALSE(found.good);
    const PointSet arch({0, 0, 0.3, 0.2, 0.7, 0.2, 1, 0}, 2);
    EXPECT_EQ(check_between(Spline({KnotVector(3, {0, 0, 0, 0, 1, 1, 1, 1})}, arch), samples,
                            {0, 1}, {0.5, 0.5})
                  .loops,
              0);
}

TEST(Between, a_surface_that_bulges_between_the_samples_is_found) {
    // samples of the plane z = 0 on a 5 x 5 grid; the surface hits them and is 0.2 high in one cell
    Samples samples;
    PointSet points(25, 3);
    for (Index i = 0; i < 25; ++i) {
        points(i, 0) = static_cast<double>(i / 5) / 4;
        points(i, 1) = static_cast<double>(i % 5) / 4;
    }
    samples.points = Points(points);
    samples.grid = {5, 5};
    const std::vector<double> t{0, 0.25, 0.5, 0.75, 1};
    const std::vector<double> tolerance(25, 0.05);
    const KnotVector fine(1, {0, 0, 0.25, 0.375, 0.5, 0.75, 1, 1});
    PointSet control(36, 3);
    const std::vector<double> at{0, 0.25, 0.375, 0.5, 0.75, 1};
    for (Index i = 0; i < 6; ++i)
        for (Index j = 0; j < 6; ++j) {
            control(i * 6 + j, 0) = at[static_cast<std::size_t>(i)];
            control(i * 6 + j, 1) = at[static_cast<std::size_t>(j)];
        }
    EXPECT_TRUE(
        check_between_grid(Spline({fine, fine}, control), samples, {{t, t}, {}}, tolerance).good);
    control(2 * 6 + 2, 2) = 0.2;
    const BetweenSamples found =
        check_between_grid(Spline({fine, fine}, control), samples, {{t, t}, {}}, tolerance);
    EXPECT_NEAR(found.excess, 0.2 / 0.1, 1e-12); // the plane has no bend: 2 T are allowed
    EXPECT_EQ(found.worst_sample, 6);
}

} // namespace
} // namespace batten
