#include "problems.hpp"

#include <batten/shape/polygon.hpp>

namespace batten {
namespace {

PointSet shifted(PointSet polygon, double by) {
    for (double& x : polygon.values()) x += by;
    return polygon;
}

TEST(TurnSigns, are_none_where_only_rounding_turns) {
    PointSet line(40, 2); // on y = 0.3 x, each coordinate rounded in its own way
    for (Index i = 0; i < 40; ++i) {
        const double x = 0.1 * static_cast<double>(i) + 0.01 * static_cast<double>(i * i % 7);
        line(i, 0) = x;
        line(i, 1) = 0.3 * x;
    }
    for (double by : {0.0, 1.0, 1e6, -1e9}) {
        const std::vector<int> signs = turn_signs(shifted(line, by));
        EXPECT_EQ(signs, std::vector<int>(38, 0)) << by;
    }
}

TEST(TurnSigns, of_a_circle_hold_at_any_offset_that_shows_them) {
    PointSet circle(20, 2);
    for (Index i = 0; i < 20; ++i) {
        circle(i, 0) = std::cos(0.3 * static_cast<double>(i));
        circle(i, 1) = std::sin(0.3 * static_cast<double>(i));
    }
    for (double by : {0.0, 1e3, 1e9})
        EXPECT_EQ(turn_signs(shifted(circle, by)), std::vector<int>(18, 1)) << by;
}

} // namespace
} // namespace batten
