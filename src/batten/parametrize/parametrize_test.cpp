#include "problems.hpp"

namespace batten {
namespace {

using testing::message_of;
using testing::sequence;

TEST(Parametrize, follows_its_rules) {
    const PointSet points({0, 0, 3, 4, 3, 4, 3, 13}, 2); // chords 5, 0, 9
    const auto chord = parametrize_sequence(points, Parametrization::chord);
    EXPECT_EQ(chord, (std::vector<double>{0, 5.0 / 14, 5.0 / 14, 1}));
    const auto centripetal = parametrize_sequence(points, Parametrization::centripetal);
    EXPECT_DOUBLE_EQ(centripetal[1], std::sqrt(5.0) / (std::sqrt(5.0) + 3));
    EXPECT_EQ(parametrize_sequence(points, Parametrization::uniform),
              (std::vector<double>{0, 1.0 / 3, 2.0 / 3, 1}));
}

TEST(Parametrize, a_closed_run_counts_the_way_back) {
    const PointSet square({0, 0, 1, 0, 1, 1, 0, 1}, 2);
    EXPECT_EQ(parametrize_sequence(square, Parametrization::chord, Closure::closed),
              (std::vector<double>{0, 0.25, 0.5, 0.75}));
}

TEST(Parametrize, a_grid_averages_normalised_rows_and_skips_poles) {
    Samples samples;
    // 3 x 3; the first row of axis 1 collapses to a point
    samples.points = Points(PointSet({0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 4, 1, 0, 2, 3, 2, 4, 2}, 2));
    samples.grid = {3, 3};
    const Parameters p =
        parametrize(samples, Parametrization::chord, {Closure::open, Closure::open});
    EXPECT_DOUBLE_EQ(p.axes[1][1], (0.25 + 0.75) / 2);
    EXPECT_EQ(p.axes[0].size(), 3U);
}

TEST(Parametrize, refuses_what_has_no_length) {
    EXPECT_EQ(message_of<InvalidInput>([] {
                  parametrize_sequence(PointSet({2, 2, 2, 2, 2, 2}, 2), Parametrization::chord);
              }),
              "axis 0: all points are identical; a curve through them has no length");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  parametrize_sequence(PointSet({2, 2}, 2), Parametrization::chord);
              }),
              "axis 0: 1 sample, at least 2 are needed");
}

TEST(Parametrize, checks_given_parameters) {
    const Samples samples = sequence(PointSet(3, 2));
    const auto refusal = [&](std::vector<double> t) {
        return message_of<InvalidInput>([&] { check(Parameters{{t}, {}}, samples); });
    };
    EXPECT_EQ(refusal({0, 1}), "axis 0: 2 parameters given for 3 samples");
    EXPECT_EQ(refusal({0, 2, 1}), "axis 0: parameter 2 = 1 is less than the one before, 2");
    EXPECT_EQ(refusal({0, NAN, 1}), "axis 0: parameter 1 is not a finite number");
    EXPECT_EQ(refusal({1, 1, 1}), "axis 0: all parameters are 1");
}

TEST(Samples, are_checked) {
    Samples samples = sequence(PointSet({0, 0, 1, NAN, 2, 2}, 2));
    EXPECT_EQ(message_of<InvalidInput>([&] { check(samples); }),
              "sample 1: its coordinates (1, nan) must be finite numbers");
    samples = sequence(PointSet(6, 2));
    samples.grid = {2, 4};
    EXPECT_EQ(message_of<InvalidInput>([&] { check(samples); }),
              "grid: 2x4 needs 8 samples, got 6");
    samples.grid.clear();
    samples.weights = {1, 1, 0, 1, 1, 1};
    EXPECT_EQ(message_of<InvalidInput>([&] { check(samples); }),
              "weight 2: 0 must be positive and finite");
    samples.weights = {1};
    EXPECT_EQ(message_of<InvalidInput>([&] { check(samples); }),
              "weights: 1 given for 6 samples; one per sample is needed");
    EXPECT_EQ(message_of<InvalidInput>([&] { check(sequence(PointSet(0, 2))); }),
              "samples: there are none");
    EXPECT_EQ(message_of<InvalidInput>([&] { check(sequence(PointSet(3, 17))); }),
              "samples: dimension 17 is outside 1 to 16");
}

TEST(Samples, generated_sections_have_their_definition) {
    const Samples wing = naca4("2412", 201);
    double thickest = 0;
    for (Index i = 0; i <= 100; ++i)
        thickest = std::max(thickest, distance(wing.points[i], wing.points[200 - i]));
    EXPECT_NEAR(thickest, 0.12, 2e-4); // 12 % thick, where the sampling finds it
    EXPECT_EQ(message_of<InvalidInput>([] { generate("naca2413"); }),
              "unknown data set 'naca2413'; did you mean 'naca2412'?");
}

} // namespace
} // namespace batten
