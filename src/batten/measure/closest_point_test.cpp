#include "problems.hpp"

#include <batten/measure/deviation.hpp>

#include <limits>
#include <numbers>

namespace batten {
namespace {

using testing::message_of;
using testing::random_points;
using testing::sequence;

/// Knots with random steps, one of them repeated as often as the degree allows, another twice.
KnotVector random_knots(int degree, Index pieces, Closure closure, unsigned seed) {
    const PointSet steps = random_points(pieces, 1, seed);
    std::vector<double> breaks{0.5};
    for (Index k = 0; k < pieces; ++k)
        breaks.push_back(breaks.back() + std::pow(10.0, 1.5 * steps(k, 0)));
    std::vector<double> knots; // of one period from the second break on, or between the ends
    for (std::size_t k = 1; k + 1 < breaks.size(); ++k)
        knots.insert(knots.end(),
                     k == 1   ? static_cast<std::size_t>(degree)
                     : k == 2 ? 2
                              : 1,
                     breaks[k]);
    if (degree == 1) knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    if (closure == Closure::open) {
        knots.insert(knots.begin(), static_cast<std::size_t>(degree + 1), breaks.front());
        knots.insert(knots.end(), static_cast<std::size_t>(degree + 1), breaks.back());
        return {degree, knots, closure};
    }
    const double period = breaks.back() - breaks.front();
    knots.insert(knots.begin(), breaks.front());
    const auto n = static_cast<Index>(knots.size());
    std::vector<double> around;
    for (Index k = -degree; k <= n + degree; ++k) {
        const Index turn = k < 0 ? (k - n + 1) / n : k / n;
        around.push_back(knots[static_cast<std::size_t>(k - turn * n)] +
                         static_cast<double>(turn) * period);
    }
    return {degree, around, closure};
}

/// A spline with random control points: 1 to 3 axes.
Spline random_spline(const std::vector<int>& degrees, Index pieces, Closure closure, Index dim,
                     unsigned seed) {
    std::vector<KnotVector> axes;
    Index count = 1;
    for (int degree : degrees) {
        // a period has to hold degree + 1 spans
        const Index n = closure == Closure::closed ? std::max<Index>(pieces, degree + 1) : pieces;
        axes.push_back(random_knots(degree, n, closure, seed++));
        count *= axes.back().free_count();
    }
    return Spline::from_free(std::move(axes), random_points(count, dim, seed));
}

std::vector<double> even(double begin, double end, Index count) {
    std::vector<double> t;
    for (Index i = 0; i < count; ++i)
        t.push_back(std::lerp(begin, end, static_cast<double>(i) / static_cast<double>(count - 1)));
    return t;
}

/// Many points of every piece.
PointSet dense(const Spline& spline, Index per_piece) {
    std::vector<std::vector<double>> parameters;
    for (const KnotVector& knots : spline.axes()) {
        const std::vector<double> breaks = knots.breakpoints();
        std::vector<double>& t = parameters.emplace_back();
        for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
            std::ranges::copy(even(breaks[k], breaks[k + 1], per_piece), std::back_inserter(t));
    }
    return evaluate_grid(spline, parameters);
}

double nearest(const PointSet& points, std::span<const double> to) {
    double best = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < points.size(); ++k) best = std::min(best, distance(points[k], to));
    return best;
}

/// A distance that is attained where it is said to be, and that no point of the spline undercuts,
/// is the least: no tolerance but rounding's.
void expect_least(const Spline& spline, const PointSet& points, Index per_piece,
                  const std::string& name) {
    const PointSet many = dense(spline, per_piece);
    const std::vector<ClosestPoint> found = closest_points(spline, points);
    for (Index i = 0; i < points.size(); ++i) {
        const ClosestPoint& c = found[static_cast<std::size_t>(i)];
        // a parameter of about 100 is known to 1e-14, and pieces may be 0.03 long
        EXPECT_NEAR(distance(spline(c.parameter), points[i]), c.distance, 1e-12) << name << i;
        EXPECT_LE(c.distance, nearest(many, points[i]) + 1e-12) << name << i;
        for (std::size_t a = 0; a < c.parameter.size(); ++a) {
            EXPECT_GE(c.parameter[a], spline.axes()[a].begin());
            EXPECT_LE(c.parameter[a], spline.axes()[a].end());
        }
    }
}

Spline bezier(std::vector<double> control, Index dim) {
    const int degree = static_cast<int>(control.size()) / static_cast<int>(dim) - 1;
    std::vector<double> knots(static_cast<std::size_t>(2 * degree + 2), 0.0);
    std::fill(knots.begin() + degree + 1, knots.end(), 1.0);
    return {{KnotVector(degree, knots)}, PointSet(std::move(control), dim)};
}

/// (2 s, 4 s^2) for s from -1 to 1: the parabola y = x^2.
Spline parabola() {
    return bezier({-2, 4, 0, -4, 2, 4}, 2);
}

double distance_to(const Spline& spline, std::vector<double> point) {
    const auto dim = static_cast<Index>(point.size());
    return closest_distances(spline, PointSet(std::move(point), dim)).front();
}

TEST(ClosestPoint, of_random_curves_is_the_least) {
    unsigned seed = 1;
    for (int degree = 1; degree <= 9; ++degree)
        for (Closure closure : {Closure::open, Closure::closed})
            for (Index dim : {1, 2, 3, 16}) {
                const Spline curve = random_spline({degree}, 7, closure, dim, ++seed * 10);
                PointSet points = random_points(40, dim, seed);
                for (Index i = 0; i < 10; ++i) // near it as well
                    for (Index d = 0; d < dim; ++d)
                        points(i, d) = 1e-3 * points(i, d) + curve.control_points()(i % 7, d);
                expect_least(curve, points, 400,
                             "degree " + std::to_string(degree) + " seed " + std::to_string(seed) +
                                 " point ");
            }
}

TEST(ClosestPoint, of_random_surfaces_and_volumes_is_the_least) {
    const std::vector<std::vector<int>> degrees{{1, 1}, {3, 3}, {2, 5}, {4, 1}, {7, 9}, {1, 2, 3}};
    unsigned seed = 1000;
    for (const auto& degree : degrees)
        for (Closure closure : {Closure::open, Closure::closed})
            for (Index dim : {2, 3, 4}) {
                const Spline spline = random_spline(degree, 3, closure, dim, seed += 10);
                const Index per_piece = degree.size() == 2 ? 40 : 8;
                PointSet points = random_points(8, dim, seed);
                for (Index i = 0; i < 4; ++i)
                    for (Index d = 0; d < dim; ++d) points(i, d) *= 2;
                expect_least(spline, points, per_piece, "seed " + std::to_string(seed) + " point ");
            }
}

TEST(ClosestPoint, of_a_polyline_is_that_of_its_segments) {
    const PointSet corners = random_points(60, 3, 5);
    std::vector<double> knots = even(0, 59, 60);
    knots.insert(knots.begin(), 0);
    knots.push_back(59);
    const Spline line({KnotVector(1, knots)}, corners);
    const PointSet points = random_points(300, 3, 6);
    const std::vector<double> found = closest_distances(line, points);
    for (Index i = 0; i < points.size(); ++i) {
        double least = 1e9;
        for (Index k = 0; k + 1 < corners.size(); ++k) {
            double along = 0;
            double length = 0;
            for (Index d = 0; d < 3; ++d) {
                const double side = corners(k + 1, d) - corners(k, d);
                along += side * (points(i, d) - corners(k, d));
                length += side * side;
            }
            const double s = std::clamp(along / length, 0.0, 1.0);
            double square = 0;
            for (Index d = 0; d < 3; ++d) {
                const double gap = std::lerp(corners(k, d), corners(k + 1, d), s) - points(i, d);
                square += gap * gap;
            }
            least = std::min(least, std::sqrt(square));
        }
        EXPECT_NEAR(found[static_cast<std::size_t>(i)], least, 1e-14);
    }
}

TEST(ClosestPoint, of_a_parabola_is_known) {
    // from (0, h) two points are equally near when h > 1/2; at the centre of curvature, h = 1/2,
    // the distance is flat to fourth order
    for (double h : {0.5, 0.5 + 1e-9, 0.6, 1.0, 3.0})
        EXPECT_NEAR(distance_to(parabola(), {0, h}), std::sqrt(h - 0.25), 1e-14) << h;
    EXPECT_NEAR(distance_to(parabola(), {0, -2}), 2, 1e-15);
    EXPECT_EQ(distance_to(parabola(), {0, 0}), 0);
    EXPECT_NEAR(distance_to(parabola(), {-2, 4}), 0, 0); // an end
    EXPECT_NEAR(distance_to(parabola(), {-3, 4.25}), std::sqrt(1 + 0.0625), 1e-15);
    // the foot of the normal in (x, x^2), a little off it
    for (double off : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        const double x = 0.7;
        const double n = std::sqrt(1 + 4 * x * x);
        EXPECT_NEAR(distance_to(parabola(), {x - 2 * x / n * off, x * x + off / n}), off, 1e-15);
    }
}

TEST(ClosestPoint, of_a_cusp_and_of_a_crossing_is_known) {
    const Spline cusp = bezier({1, -1, -1.0 / 3, 1, -1.0 / 3, -1, 1, 1}, 2); // (s^2, s^3), |s| <= 1
    for (double x : {1.0, 1e-3, 1e-9, 1e-13, 0.0})
        EXPECT_NEAR(distance_to(cusp, {-x, 0}), x, 1e-15) << x;
    EXPECT_NEAR(distance_to(cusp, {0.25, 0.125}), 0, 1e-15);
    // (s^2, s^3 - s / 4) crosses itself in (1/4, 0), between s = -1/2 and 1/2
    const Spline loop = bezier({1, -0.75, -1.0 / 3, 13.0 / 12, -1.0 / 3, -13.0 / 12, 1, 0.75}, 2);
    EXPECT_NEAR(distance_to(loop, {0.25, 0}), 0, 1e-15);
    const ClosestPoint left = closest_points(loop, PointSet({0.2, 0.0}, 2)).front();
    EXPECT_NEAR(distance(loop(left.parameter), std::array{0.2, 0.0}), left.distance, 1e-15);
    EXPECT_LE(left.distance, nearest(dense(loop, 100001), std::array{0.2, 0.0}));
}

TEST(ClosestPoint, of_the_centre_of_a_round_curve_needs_every_piece) {
    // a polygon's corners at one distance from the centre, the middles of its sides at another
    const Index n = 1000;
    PointSet corners(n, 2);
    for (Index i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        corners(i, 0) = std::cos(angle);
        corners(i, 1) = std::sin(angle);
    }
    const Spline ring =
        Spline::from_free({KnotVector(1, even(-1, 1001, 1003), Closure::closed)}, corners);
    const double middle = std::cos(std::numbers::pi / static_cast<double>(n));
    EXPECT_NEAR(distance_to(ring, {0, 0}), middle, 1e-14);
    EXPECT_NEAR(distance_to(ring, {2, 0}), 1, 1e-14);
}

TEST(ClosestPoint, of_a_single_point_is_it) {
    const Spline curve = bezier({3, 4, 3, 4, 3, 4, 3, 4}, 2);
    EXPECT_EQ(distance_to(curve, {3, 4}), 0);
    EXPECT_NEAR(distance_to(curve, {0, 0}), 5, 1e-15);
    EXPECT_NEAR(distance_to(curve, {3, 4 + 1e-9}), 1e-9, 1e-15);
    const KnotVector knots(2, {0, 0, 0, 1, 1, 1});
    EXPECT_NEAR(distance_to(Spline({knots, knots}, PointSet(9, 3)), {1e-200, 0, 0}), 1e-200,
                1e-215);
}

TEST(ClosestPoint, where_pieces_have_no_length_is_found_too) {
    // control points that coincide: three pieces of no length, and an edge of a surface that is a
    // point
    const Spline still({KnotVector(2, {0, 0, 0, 1, 2, 3, 4, 5, 5, 5})},
                       PointSet({0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 0}, 2));
    EXPECT_NEAR(distance_to(still, {1, 3}), 2, 1e-14);
    const KnotVector line(1, {0, 0, 1, 1});
    const Spline fan({line, line}, PointSet({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)); // triangle
    EXPECT_NEAR(distance_to(fan, {0, 0, 1e-7}), 1e-7, 1e-15);
    EXPECT_NEAR(distance_to(fan, {-3, -4, 0}), 5, 1e-14);
    EXPECT_NEAR(distance_to(fan, {1, 1, 2}), std::sqrt(4.5), 1e-14);
    EXPECT_NEAR(distance_to(fan, {0.25, 0.25, 0.5}), 0.5, 1e-15);
}

TEST(ClosestPoint, of_a_box_is_zero_inside_and_known_outside) {
    const KnotVector knots(1, {0, 0, 0.5, 1, 1});
    PointSet control(27, 3);
    for (Index i = 0; i < 27; ++i) {
        control(i, 0) = static_cast<double>(i / 9);
        control(i, 1) = static_cast<double>(i / 3 % 3);
        control(i, 2) = static_cast<double>(i % 3);
    }
    const Spline box({knots, knots, knots}, control); // 0 to 2 along each axis
    EXPECT_NEAR(distance_to(box, {0.3, 1.7, 1.0}), 0, 1e-14);
    EXPECT_NEAR(distance_to(box, {1, 1, 3.5}), 1.5, 1e-14);
    EXPECT_NEAR(distance_to(box, {-1, -2, 4}), 3, 1e-14);
}

TEST(ClosestPoint, scales_with_powers_of_two_and_stays_at_offsets) {
    const Spline curve = random_spline({3}, 9, Closure::open, 3, 77);
    const PointSet points = random_points(50, 3, 78);
    const std::vector<double> usual = closest_distances(curve, points);
    for (double scale : {0x1p-498, 0x1p-40, 0x1p498}) { // 1e-150, 1e-12, 1e150
        PointSet control = curve.control_points();
        PointSet scaled = points;
        for (double& x : control.values()) x *= scale;
        for (double& x : scaled.values()) x *= scale;
        const auto found = closest_distances(Spline(curve.axes(), control), scaled);
        for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], usual[i] * scale);
    }
    PointSet control = curve.control_points(); // to multiples of 2^-20, which an offset keeps
    PointSet moved = points;
    for (double& x : control.values()) x = std::round(x * 0x1p20) * 0x1p-20;
    for (double& x : moved.values()) x = std::round(x * 0x1p20) * 0x1p-20;
    const auto near = closest_distances(Spline(curve.axes(), control), moved);
    for (double& x : control.values()) x += 0x1p30;
    for (double& x : moved.values()) x += 0x1p30;
    const auto away = closest_distances(Spline(curve.axes(), control), moved);
    for (std::size_t i = 0; i < near.size(); ++i) EXPECT_EQ(away[i], near[i]);
}

TEST(ClosestPoint, of_points_far_away_is_right_to_rounding) {
    const Spline curve = random_spline({3}, 9, Closure::open, 2, 7);
    const PointSet many = dense(curve, 1000);
    for (double far : {1e3, 1e8, 1e15, 1e40, 1e200}) {
        double least = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < many.size(); ++k)
            least = std::min(least, std::hypot(many(k, 0) - 3 * far, many(k, 1) - 4 * far));
        const double steps = 1e-6 / far; // of the dense search
        EXPECT_NEAR(distance_to(curve, {3 * far, 4 * far}) / least, 1, 1e-12 + steps);
    }
}

TEST(ClosestPoint, depends_neither_on_threads_nor_on_where_it_starts) {
    const Spline surface = random_spline({3, 2}, 8, Closure::open, 3, 55);
    const Samples samples = sequence(random_points(3000, 3, 56));
    const std::vector<double> found = closest_distances(surface, samples.points);
    {
        const ThreadLimit one(1);
        EXPECT_EQ(closest_distances(surface, samples.points), found);
    }
    Parameters starts{.scattered = random_points(3000, 2, 57)};
    for (double& t : starts.scattered.values()) t *= 1000; // beyond both ends as well
    const std::vector<double> started = closest_distances(surface, samples, starts);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(started[i], found[i], 1e-12);
    Samples grid = sequence(random_points(12, 3, 58));
    grid.grid = {3, 4};
    const auto plain = closest_distances(surface, grid.points);
    const auto on_grid = closest_distances(surface, grid, {.axes = {{0, 1, 2}, {0, 1, 2, 3}}});
    for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_NEAR(on_grid[i], plain[i], 1e-12);
}

TEST(ClosestPoint, refuses_what_cannot_be) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(message_of<InvalidInput>([] {
                  distance_to(parabola(), {1, 2, 3});
              }),
              "the points have dimension 3, the spline has 2");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  distance_to(parabola(), {1, nan});
              }),
              "point 0 has a coordinate that is not finite");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  distance_to(bezier({0, 0, nan, 1}, 2), {1, 1});
              }),
              "control point 1 has a coordinate that is not finite");
    const Samples two = sequence(random_points(2, 2, 1));
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  closest_distances(parabola(), two, {.axes = {{0, 0.5, 1}}});
              }),
              "3 parameters of 1 axes given for 2 samples and 1 axes");
    EXPECT_TRUE(closest_distances(parabola(), PointSet(0, 2)).empty());
}

} // namespace
} // namespace batten
