#include "problems.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace batten {
namespace {

using testing::largest_difference;
using testing::message_of;
using testing::random_parameters;
using testing::random_points;

std::vector<double> even(double a, double b, Index count) {
    std::vector<double> t;
    for (Index i = 0; i < count; ++i)
        t.push_back(a + (b - a) * static_cast<double>(i) / static_cast<double>(count - 1));
    return t;
}

TEST(Spline, greville_abscissae_reproduce_the_line) {
    const KnotVector k = knots_from_parameters(random_parameters(60, 1), 4, 13);
    const Spline line({k}, PointSet(greville_abscissae(k), 1));
    for (double t : even(0, 1, 33)) EXPECT_NEAR(line(std::array{t})[0], t, 1e-14);
}

TEST(Spline, points_and_derivatives_agree_with_the_definition) {
    const Spline s({uniform_knots(3, 7, 0, 1), uniform_knots(4, 8, -1, 1)},
                   random_points(56, 3, 2));
    for (const auto& [u, v] : {std::pair{0.37, 0.11}, {0.0, -1.0}, {1.0, 1.0}, {0.25, 0.5}})
        for (const std::array orders :
             {std::array{0, 0}, std::array{1, 0}, std::array{1, 1}, std::array{2, 3}}) {
            const auto exact = reference::point(s, {u, v}, {orders[0], orders[1]});
            const auto found = s(std::array{u, v}, orders);
            const double scale = static_cast<double>(exact.cwiseAbs().maxCoeff());
            for (Index d = 0; d < 3; ++d)
                EXPECT_NEAR(found[static_cast<std::size_t>(d)], static_cast<double>(exact(d)),
                            1e-12 * scale)
                    << u << " " << v << " " << orders[0] << orders[1];
        }
}

TEST(Spline, grid_and_scattered_evaluation_agree_with_the_definition) {
    const Spline s({uniform_knots(2, 5, 0, 1), uniform_knots(3, 6, 0, 1, Closure::closed),
                    uniform_knots(1, 4, 0, 1)},
                   random_points(5 * 9 * 4, 2, 4));
    const std::vector<std::vector<double>> axes{even(0, 1, 4), even(0, 0.9, 5), even(0, 1, 3)};
    PointSet scattered(60, 3);
    Index row = 0;
    for (double a : axes[0])
        for (double b : axes[1])
            for (double c : axes[2]) {
                std::ranges::copy(std::array{a, b, c}, scattered[row].begin());
                ++row;
            }
    reference::Matrix exact(60, 2);
    for (Index i = 0; i < 60; ++i)
        exact.row(i) = reference::point(s, {scattered(i, 0), scattered(i, 1), scattered(i, 2)});
    EXPECT_LT(reference::difference(exact, evaluate_grid(s, axes)), 1e-14);
    EXPECT_LT(reference::difference(exact, evaluate(s, scattered)), 1e-14);
}

TEST(Spline, inserting_knots_changes_nothing) {
    for (Closure closure : {Closure::open, Closure::closed}) {
        const KnotVector k = uniform_knots(3, 8, 0, 1, closure);
        const Spline before = Spline::from_free({k}, random_points(8, 2, 6));
        for (double t : {0.0, 0.03, 0.375, 0.41, 0.999}) {
            if (t == 0 && closure == Closure::open) continue;
            const Spline after = insert_knot(before, 0, t, 2);
            EXPECT_EQ(after.axis(0).free_count(), 10);
            const auto at = even(0, 1, 101);
            EXPECT_LT(reference::difference(reference::curve_points(before, at),
                                            PointSet(evaluate_grid(after, {at}))),
                      1e-14)
                << t;
        }
    }
}

TEST(Spline, inserting_knots_into_one_axis_of_a_surface_changes_nothing) {
    const Spline before({uniform_knots(3, 6, 0, 1), uniform_knots(2, 5, 0, 1)},
                        random_points(30, 3, 8));
    const auto at = even(0, 1, 17);
    for (Index axis : {0, 1}) {
        const Spline after = insert_knot(before, axis, 0.7);
        EXPECT_LT(
            largest_difference(evaluate_grid(before, {at, at}), evaluate_grid(after, {at, at})),
            1e-14);
    }
}

/// Ascending knots in (0, 1), some a millionth apart, some twice.
std::vector<double> uneven(int degree, unsigned seed) {
    std::vector<double> knots = random_parameters(12, seed);
    for (double& t : knots) t = 0.01 + 0.98 * t;
    knots[3] = knots[2] + 1e-6;
    knots[7] = knots[6] + 1e-3;
    if (degree > 1) knots[9] = knots[8];
    std::ranges::sort(knots);
    return knots;
}

TEST(Spline, every_degree_keeps_its_shape_when_refined_and_clamped_on_uneven_knots) {
    const auto at = even(0, 1, 801);
    for (int degree = 1; degree <= max_degree; ++degree)
        for (int kind = 0; kind < 3; ++kind) {
            const auto seed = static_cast<unsigned>(10 * degree + kind);
            std::vector<double> knots = uneven(degree, seed);
            KnotVector axis;
            if (kind < 2) {
                axis =
                    knots_around(degree, knots, 0, 1, kind == 0 ? Closure::open : Closure::closed);
            } else { // ends that are close together outside the domain
                for (int k = 0; k <= degree; ++k) {
                    knots.push_back(1 + 1e-4 * k);
                    knots.push_back(-1e-4 * k);
                }
                std::ranges::sort(knots);
                axis = {degree, knots};
            }
            const Spline spline =
                Spline::from_free({axis}, random_points(axis.free_count(), 2, seed));
            const reference::Matrix exact = reference::curve_points(spline, at);
            const auto away = [&](const Spline& other) {
                return reference::difference(exact, evaluate_grid(other, {at}));
            };
            const std::string what = fmt::format("degree {}, kind {}", degree, kind);
            EXPECT_LT(away(clamped(spline)), 1e-13) << what;
            Spline fine = spline;
            for (double t : {1e-5, 0.2, 0.2 + 1e-7, 0.9, 1 - 1e-6}) fine = insert_knot(fine, 0, t);
            EXPECT_LT(away(fine), 1e-13) << what;
            EXPECT_LT(away(refine(spline, 0, fine.axis(0))), 1e-13) << what;
            EXPECT_LT(away(clamped(fine)), 1e-13) << what;
        }
}

TEST(Spline, a_closed_curve_closes_with_its_derivatives) {
    const Spline s =
        Spline::from_free({uniform_knots(4, 9, 0, 1, Closure::closed)}, random_points(9, 3, 10));
    for (int order = 0; order <= 3; ++order) { // the last piece and the first, not one wrapped
        const reference::Matrix ends = reference::curve_points(s, {0.0, 1.0}, order);
        const double scale = static_cast<double>(ends.cwiseAbs().maxCoeff());
        EXPECT_LT(static_cast<double>((ends.row(0) - ends.row(1)).cwiseAbs().maxCoeff()),
                  1e-13 * scale);
        const auto found = s(std::array{1.0}, std::array{order});
        for (Index d = 0; d < 3; ++d)
            EXPECT_NEAR(found[static_cast<std::size_t>(d)], static_cast<double>(ends(1, d)),
                        1e-12 * scale);
    }
}

TEST(Spline, refuses_what_breaks_a_rule) {
    const KnotVector k = uniform_knots(3, 6, 0, 1);
    EXPECT_EQ(message_of<InvalidInput>([&] { Spline({k}, PointSet(5, 2)); }),
              "spline: 5 control points given, the knots need 6");
    const Spline s({k}, PointSet(6, 2));
    EXPECT_EQ(message_of<InvalidInput>([&] { insert_knot(s, 0, 1.5); }),
              "axis 0: knot 1.5 is outside the domain [0, 1]");
    EXPECT_EQ(message_of<InvalidInput>([&] { insert_knot(s, 0, 0.5, 4); }),
              "axis 0: knot 0.5 would have a multiplicity above the degree 3");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  s(std::array{0.5, 0.5});
              }),
              "evaluate: 2 parameters given for 1 axes");
    EXPECT_EQ(message_of<InvalidInput>([&] { s(std::array{0.5}, std::array{-1}); }),
              "evaluate: derivative order -1 is negative");
}

TEST(Spline, clamped_is_the_same_spline_with_full_end_knots) {
    const KnotVector closed =
        knots_around(3, std::array{0.0, 0.2, 0.2, 0.7}, 0, 1, Closure::closed);
    const KnotVector unclamped(2, {-0.3, -0.1, 0, 0.4, 0.5, 1, 1.2, 1.3});
    const KnotVector plain = uniform_knots(1, 3, 0, 1);
    const Spline spline = Spline::from_free(
        {closed, unclamped, plain},
        random_points(closed.free_count() * unclamped.free_count() * plain.free_count(), 2, 4));
    const Spline same = clamped(spline);
    for (const KnotVector& axis : same.axes()) {
        EXPECT_FALSE(axis.closed());
        EXPECT_EQ(std::ranges::count(axis.knots(), axis.begin()), axis.degree() + 1);
        EXPECT_EQ(std::ranges::count(axis.knots(), axis.end()), axis.degree() + 1);
    }
    const std::vector<double> t = even(0, 1, 21);
    EXPECT_LT(largest_difference(evaluate_grid(spline, {t, t, t}), evaluate_grid(same, {t, t, t})),
              1e-13);
}

} // namespace
} // namespace batten
