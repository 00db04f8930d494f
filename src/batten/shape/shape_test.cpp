#include "problems.hpp"

#include <batten/shape/limits.hpp>

namespace batten {
namespace {

using testing::random_points;

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
    for (unsigned seed = 0; seed < 200; ++seed) {
        const PointSet polygon = random_points(12, 2, seed);
        const Closure closure = seed % 2 == 0 ? Closure::open : Closure::closed;
        const auto wanted = turn_signs(polygon, closure);
        for (int which = 0; which < 2; ++which) {
            PointSet moves = random_points(12, 2, seed + 1000);
            which == 0 ? keep_turns(polygon, moves, closure)
                       : keep_inflections(polygon, moves, closure);
            PointSet moved = polygon;
            add_scaled(moved, 1, moves);
            EXPECT_EQ(turn_signs(moved, closure), wanted) << which << " seed " << seed;
        }
    }
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
    EXPECT_LE(ray(2, 1), whole(2, 1));   // a ray holds no more than its line
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
