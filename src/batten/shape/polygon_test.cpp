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

TEST(TurnSigns, are_exact_where_they_are_asked_to_be) {
    // a turn at a point of the diagonal, after one some ulps beside it
    const double ulp = std::ldexp(1.0, -53);
    int wrong = 0;
    for (int x = 0; x < 64; ++x)
        for (int y = 0; y < 64; ++y) {
            const std::array p{0.5 + x * ulp, 0.5 + y * ulp};
            const std::array q{12.0, 12.0};
            const std::array r{24.0, 24.0};
            const int truth = (p[1] > p[0]) - (p[1] < p[0]);
            EXPECT_EQ(turn_sign(p, q, r, exactly), truth);
            EXPECT_EQ(turn_sign(r, q, p, exactly), -truth);
            const double t = turn(p, q, r);
            wrong += ((t > 0) - (t < 0)) != truth ? 1 : 0;
        }
    EXPECT_GT(wrong, 100); // in doubles
}

} // namespace
} // namespace batten
