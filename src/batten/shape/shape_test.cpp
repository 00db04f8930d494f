#include "problems.hpp"

#include <batten/shape/limits.hpp>

namespace batten {
namespace {

using testing::random_points;

/// The signs of the turns at the inner points (closed: at all), from cross products.
std::vector<int> signs(const PointSet& polygon, Closure closure) {
    const Index n = polygon.size();
    std::vector<int> found;
    for (Index k = 0; k < (closure == Closure::closed ? n : n - 2); ++k) {
        const Index i = closure == Closure::closed ? (k + n - 1) % n : k;
        const auto edge = [&](Index from, Index d) {
            return reference::Long(polygon((from + 1) % n, d)) - polygon(from % n, d);
        };
        const reference::Long cross = edge(i, 0) * edge(i + 1, 1) - edge(i, 1) * edge(i + 1, 0);
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
    // the middle point moves down across the line through its neighbours, far outside the stretch
    // between them
    const PointSet polygon({0, 0, 1, 0, 5, 1, 2, 0.1, 3, 0}, 2);
    PointSet moves(5, 2);
    moves(2, 1) = -3;
    PointSet lines = moves;
    keep_inflections(polygon, lines, Closure::open, 0.8, Barrier::lines);
    EXPECT_GT(lines(2, 1), -3);
    const PointSet far({0, 0, 1, 0, -5, 1, 2, 0, 3, 0},
                       2); // meets the line through (1, 0) and (2, 0) behind both
    PointSet whole(5, 2);
    whole(2, 1) = -3;
    PointSet ray = whole;
    keep_inflections(far, whole, Closure::open, 0.8, Barrier::lines);
    keep_inflections(far, ray, Closure::open, 0.8, Barrier::rays);
    EXPECT_DOUBLE_EQ(whole(2, 1), -0.8); // 0.8 of the way to the line
    EXPECT_DOUBLE_EQ(ray(2, 1), -3);     // it meets no ray, and moves freely
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
