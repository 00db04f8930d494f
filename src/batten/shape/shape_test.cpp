#include "problems.hpp"

#include <batten/shape/limits.hpp>

namespace batten {
namespace {

using testing::random_points;

/// The signs of the turns at points 1, 2, ... (closed: n of them), from cross products.
std::vector<int> signs(const PointSet& polygon, Closure closure) {
    const Index n = polygon.size();
    std::vector<int> found;
    for (Index k = 0; k < (closure == Closure::closed ? n : n - 2); ++k) {
        const auto edge = [&](Index from, Index d) {
            return reference::Long(polygon((from + 1) % n, d)) - polygon(from % n, d);
        };
        const reference::Long cross = edge(k, 0) * edge(k + 1, 1) - edge(k, 1) * edge(k + 1, 0);
        found.push_back(cross > 0 ? 1 : cross < 0 ? -1 : 0);
    }
    return found;
}

TEST(Polygon, counts_turns_and_inflections) {
    const PointSet zigzag({0, 0, 1, 1, 2, 0, 2, 0, 3, 1}, 2);
    EXPECT_EQ(turn_signs(zigzag), (std::vector<int>{-1, 1}));
    EXPECT_EQ(inflection_count(zigzag), 1);
    const PointSet square({0, 0, 1, 0, 1, 1, 0, 1}, 2);
    EXPECT_EQ(turn_signs(square, Closure::closed), (std::vector<int>{1, 1, 1, 1}));
    EXPECT_EQ(inflection_count(square, Closure::closed), 0);
    EXPECT_EQ(turn_signs(PointSet({0, 0, 1, 0, 2, 0}, 2)), (std::vector<int>{0}));
}

void keep_turns_by_default(const PointSet& polygon, PointSet& moves) {
    keep_turns(polygon, moves);
}

void keep_inflections_by_default(const PointSet& polygon, PointSet& moves) {
    keep_inflections(polygon, moves);
}

TEST(Limits, keep_every_turn_for_any_moves) {
    int would_break = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        const PointSet polygon = random_points(12, 2, seed);
        const Closure closure = seed % 2 == 0 ? Closure::open : Closure::closed;
        const auto wanted = signs(polygon, closure);
        EXPECT_EQ(turn_signs(polygon, closure), wanted) << seed;
        for (int which = 0; which < 2; ++which) {
            const PointSet free = random_points(12, 2, seed + 1000);
            PointSet moves = free;
            which == 0 ? keep_turns(polygon, moves, closure)
                       : keep_inflections(polygon, moves, closure);
            PointSet moved = polygon;
            add_scaled(moved, 1, moves);
            EXPECT_EQ(signs(moved, closure), wanted) << which << " seed " << seed;
            // the limit shortens moves, it does not forbid or turn them
            EXPECT_GT(frobenius_norm(moves), 0) << which << " seed " << seed;
            for (Index i = 0; i < 12; ++i) {
                EXPECT_NEAR(moves(i, 0) * free(i, 1), moves(i, 1) * free(i, 0), 1e-15);
                EXPECT_LE(std::abs(moves(i, 0)), std::abs(free(i, 0)));
            }
            moved = polygon;
            add_scaled(moved, 1, free);
            would_break += signs(moved, closure) != wanted ? 1 : 0;
        }
    }
    EXPECT_GT(would_break, 390); // of 400: nearly every such step breaks a turn when it is free
}

TEST(Limits, rays_hold_only_on_the_neighbours_side) {
    // point 2 falls across the line through points 0 and 1; the ray leaves point 1 through point 0
    const auto fall = [](double x, Barrier barrier) {
        PointSet moves(5, 2);
        moves(2, 1) = -3;
        keep_inflections(PointSet({0, 0, 1, 0, x, 1, 3, 10, 4, 10}, 2), moves, Closure::open,
                         {.barrier = barrier});
        return moves(2, 1);
    };
    const double held = -0.8;                         // 0.8 of the way to the line
    EXPECT_DOUBLE_EQ(fall(-1, Barrier::lines), held); // before point 0
    EXPECT_DOUBLE_EQ(fall(-1, Barrier::rays), held);
    EXPECT_DOUBLE_EQ(fall(2, Barrier::lines), held); // behind point 1, where no ray is
    EXPECT_DOUBLE_EQ(fall(2, Barrier::rays), -3);
}

TEST(Limits, rays_of_situation_b_go_on_beyond_the_next_point) {
    // point 2 falls across the line through points 3 and 4; N is on the far side of 3 from 4
    const auto fall = [](double x, const InflectionLimit& limit) {
        PointSet moves(5, 2);
        moves(2, 1) = -3;
        keep_inflections(PointSet({-1, 10, 0, 10, x, 1, 3, 0, 4, 0}, 2), moves, Closure::open,
                         limit);
        return moves(2, 1);
    };
    const InflectionLimit rays{.barrier = Barrier::rays};
    EXPECT_DOUBLE_EQ(fall(2, rays), -0.8);
    EXPECT_DOUBLE_EQ(fall(5, rays), -3); // on the side of 4, where no ray is
    EXPECT_DOUBLE_EQ(fall(5, {}), -0.8);
    EXPECT_DOUBLE_EQ(fall(2, {.alpha = 0.25, .barrier = Barrier::rays}), -0.25);
    EXPECT_DOUBLE_EQ(fall(2, {.alpha = 0.25}), -0.25);
}

TEST(Limits, rays_lose_turns_and_leave_both_ends_free) {
    const PointSet arch({0, 0, 1, 1, 2, 1, 3, 0}, 2);
    PointSet moves(4, 2);
    moves(0, 1) = 3; // the first point across the line through the next two
    keep_inflections(arch, moves, Closure::open, {.barrier = Barrier::rays});
    EXPECT_EQ(moves(0, 1), 3);
    keep_inflections(arch, moves);
    EXPECT_DOUBLE_EQ(moves(0, 1), 0.8);
    int lost = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        const PointSet polygon = random_points(12, 2, seed);
        PointSet any = random_points(12, 2, seed + 1000);
        keep_inflections(polygon, any, Closure::closed, {.barrier = Barrier::rays});
        PointSet moved = polygon;
        add_scaled(moved, 1, any);
        lost += signs(moved, Closure::closed) != signs(polygon, Closure::closed) ? 1 : 0;
    }
    EXPECT_GT(lost, 100); // of 200, where whole lines lose none
}

TEST(Limits, keep_every_turn_where_the_polygon_is_written) {
    for (double far : {1e3, 1e6, 1e9, 1e12})
        for (unsigned seed = 0; seed < 20; ++seed) {
            const std::vector<double> centre{far, -0.7 * far};
            const auto written = [&](PointSet polygon) {
                for (Index i = 0; i < polygon.size(); ++i)
                    for (std::size_t d = 0; d < 2; ++d) polygon[i][d] += centre[d];
                return polygon;
            };
            PointSet polygon = random_points(12, 2, seed);
            const auto before = turn_signs(polygon, Closure::closed, {kept_roundings, centre});
            for (unsigned step = 0; step < 60; ++step) { // many run into a line
                PointSet moves = random_points(12, 2, 100 * seed + 7);
                keep_inflections(polygon, moves, Closure::closed, {.centre = centre});
                add_scaled(polygon, 1, moves);
            }
            const auto after = signs(written(polygon), Closure::closed);
            for (std::size_t k = 0; k < before.size(); ++k)
                EXPECT_TRUE(before[k] == 0 || after[k] == before[k]) << far << " " << seed;
        }
}

TEST(Limits, points_slide_along_what_is_straight) {
    const PointSet run({0, 1, 1, 0, 2, 0, 3, 0, 4, 0, 5, 1}, 2); // bends to the left at both ends
    PointSet moves(6, 2);
    moves(2, 0) = 0.25;
    moves(2, 1) = 0.1; // up: to the right
    moves(3, 0) = 9;   // past the next one
    moves(3, 1) = 1e-3;
    keep_inflections(run, moves);
    EXPECT_EQ(moves(2, 0), 0.25);
    EXPECT_EQ(moves(2, 1), 0);
    EXPECT_DOUBLE_EQ(moves(3, 0), 0.8);
    EXPECT_EQ(moves(3, 1), 0);
}

TEST(Limits, let_what_is_straight_bend_but_not_to_and_fro) {
    const PointSet point(6, 2); // all in one place
    const PointSet line({0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0}, 2);
    const PointSet arc({0, 0, 1, 0.5, 2, 0.8, 3, 0.8, 4, 0.5, 5, 0}, 2);
    const PointSet wave({0, 0, 1, 0.5, 2, -0.8, 3, 0.8, 4, -0.5, 5, 0}, 2);
    const auto limits = {&keep_turns_by_default, &keep_inflections_by_default};
    for (const auto limit : limits)
        for (const PointSet* start : {&point, &line}) {
            PointSet moves = arc;
            add_scaled(moves, -1, *start);
            const PointSet free = moves;
            limit(*start, moves);
            EXPECT_EQ(moves.values(), free.values());
            moves = wave;
            add_scaled(moves, -1, *start);
            limit(*start, moves);
            PointSet moved = *start;
            add_scaled(moved, 1, moves);
            EXPECT_EQ(inflection_count(moved), 0);
        }
    // one straight place between two bends, which it may follow and not oppose
    const PointSet flat({0, 0, 1, 1, 2, 1, 3, 1, 4, 1, 5, 0}, 2);
    for (const auto limit : limits)
        for (double up : {0.1, -0.1}) {
            PointSet moves(6, 2);
            moves(2, 1) = moves(3, 1) = up;
            limit(flat, moves);
            EXPECT_EQ(moves(2, 1) == up && moves(3, 1) == up, up > 0);
            PointSet moved = flat;
            add_scaled(moved, 1, moves);
            EXPECT_EQ(inflection_count(moved), 0);
        }
}

TEST(ExactTurns, make_an_arc_of_what_is_straight_but_for_rounding) {
    for (double far : {0.0, 1.0, 1e3, 1e6})
        for (const Closure closure : {Closure::open, Closure::closed}) {
            PointSet stadium(24, 2); // open: but for the last of its sides
            for (Index i = 0; i < 24; ++i) {
                const double s = static_cast<double>(i % 12) / 6;
                const double turned = std::max(0.0, s - 1) * 3.2;
                const double side = i < 12 ? 1 : -1;
                const double x = side * (std::min(s, 1.0) * 3 + 0.5 * std::sin(turned) - 1.5);
                const double y = -0.5 * side * std::cos(turned);
                stadium(i, 0) = 0.8 * x - 0.6 * y + far;
                stadium(i, 1) = 0.6 * x + 0.8 * y - 0.7 * far;
            }
            ASSERT_EQ(inflection_count(stadium, closure, kept_roundings), 0);
            ASSERT_GT(inflection_count(stadium, closure, exactly), 0) << far;
            const PointSet exact = with_exact_turns(stadium, closure, 0);
            for (int turn : signs(exact, closure)) EXPECT_GE(turn, 0) << far;
            EXPECT_LT(reference::difference(reference::matrix(stadium), exact),
                      1e-14 * std::max(1.0, far) * 1e3)
                << far;
        }
}

TEST(ExactTurns, leave_alone_what_bends) {
    const PointSet zigzag({0, 0, 1, 1, 2, 0, 3, 1, 4, 0}, 2);
    EXPECT_EQ(with_exact_turns(zigzag, Closure::open, 0).values(), zigzag.values());
    EXPECT_EQ(with_exact_turns(zigzag, Closure::open, 2).values(), zigzag.values());
}

TEST(Limits, leave_harmless_moves_alone) {
    const PointSet polygon({0, 0, 1, 1, 2, 1, 3, 0}, 2);
    const PointSet small({0.01, 0, 0, 0.01, 0, 0.01, -0.01, 0}, 2);
    PointSet moves = small;
    keep_turns(polygon, moves);
    EXPECT_EQ(moves.values(), small.values());
    keep_inflections(polygon, moves);
    EXPECT_EQ(moves.values(), small.values());
}

} // namespace
} // namespace batten
