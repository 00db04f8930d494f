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
        keep_inflections(PointSet({0, 0, 1, 0, x, 1, 3, 10, 4, 10}, 2), moves, Closure::open, 0.8,
                         barrier);
        return moves(2, 1);
    };
    const double held = -0.8;                         // 0.8 of the way to the line
    EXPECT_DOUBLE_EQ(fall(-1, Barrier::lines), held); // before point 0
    EXPECT_DOUBLE_EQ(fall(-1, Barrier::rays), held);
    EXPECT_DOUBLE_EQ(fall(2, Barrier::lines), held); // behind point 1, where no ray is
    EXPECT_DOUBLE_EQ(fall(2, Barrier::rays), -3);
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
