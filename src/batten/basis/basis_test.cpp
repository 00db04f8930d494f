#include "problems.hpp"

namespace batten {
namespace {

using testing::message_of;

TEST(Basis, agrees_with_the_recursive_definition_for_every_degree) {
    for (int p = 1; p <= max_degree; ++p) {
        const KnotVector k = knots_from_parameters(testing::random_parameters(60, 7), p, p + 8);
        for (double t : testing::random_parameters(40, 11)) {
            const Index span = k.span(t);
            const BasisValues value = basis_values(k, span, t);
            double sum = 0;
            for (int r = 0; r <= p; ++r) {
                const double v = value[static_cast<std::size_t>(r)];
                sum += v;
                EXPECT_NEAR(v,
                            static_cast<double>(
                                reference::basis(k, reference::span_of(k, t), span - p + r, p, t)),
                            1e-13)
                    << "degree " << p << " t " << t;
            }
            EXPECT_NEAR(sum, 1, 1e-14); // partition of unity
        }
    }
}

TEST(Basis, derivatives_agree_with_the_recursive_definition) {
    for (int p = 1; p <= max_degree; ++p) {
        const KnotVector k = knots_from_parameters(testing::random_parameters(60, 17), p, p + 8);
        for (double t : {0.0, 0.231, 0.5, 0.77, 1.0}) { // the ends from inside
            const Index span = k.span(t);
            for (int order = 1; order <= p; ++order) {
                const BasisValues found = basis_derivatives(k, span, t, order);
                std::vector<double> exact;
                double scale = 0;
                for (int r = 0; r <= p; ++r) {
                    exact.push_back(static_cast<double>(
                        reference::basis(k, reference::span_of(k, t), span - p + r, p, t, order)));
                    scale = std::max(scale, std::abs(exact.back()));
                }
                for (std::size_t r = 0; r < exact.size(); ++r)
                    EXPECT_NEAR(found[r], exact[r], 1e-12 * scale)
                        << "degree " << p << " order " << order << " t " << t;
            }
        }
    }
    const KnotVector k = uniform_knots(5, 9, 0, 2);
    EXPECT_EQ(basis_derivatives(k, k.span(0.77), 0.77, 6)[0], 0);
}

TEST(Basis, the_derivatives_of_all_b_splines_sum_to_zero) {
    const KnotVector k = knots_from_parameters(testing::random_parameters(50, 3), 4, 12);
    for (double t : testing::random_parameters(30, 5)) {
        double sum = 0;
        for (double v : basis_derivatives(k, k.span(t), t, 1)) sum += v;
        EXPECT_NEAR(sum, 0, 1e-10);
    }
}

TEST(Knots, follow_equation_9_69) {
    // m + 1 = 10 parameters, degree 3, n + 1 = 6 control points: d = 10 / 3, interior knots at j d
    std::vector<double> t{0, 0.1, 0.2, 0.3, 0.45, 0.5, 0.6, 0.75, 0.9, 1};
    const KnotVector k = knots_from_parameters(t, 3, 6);
    ASSERT_EQ(k.knots().size(), 10U);
    EXPECT_DOUBLE_EQ(k[4], (1 - 1.0 / 3) * 0.2 + 1.0 / 3 * 0.3); // 3.333: between t_2 and t_3
    EXPECT_DOUBLE_EQ(k[5], (1 - 2.0 / 3) * 0.5 + 2.0 / 3 * 0.6); // 6.667: between t_5 and t_6
}

TEST(Knots, ascend_among_parameters_that_repeat) {
    for (int places = 2; places < 40; ++places) {
        std::vector<double> t;
        for (int k = 0; k < places; ++k)
            for (int j = 0; j < 3 + 7 * k % 11; ++j) t.push_back(k * 0.1 / places + 0.9 * k / 97);
        for (Closure closure : {Closure::open, Closure::closed})
            for (Index n = max_degree + 1; n < places; ++n)
                EXPECT_NO_THROW(
                    knots_from_parameters(t, max_degree, n, closure, KnotPlacement::both_ends));
    }
}

TEST(Knots, a_closed_axis_is_periodic_and_wraps) {
    const KnotVector k = uniform_knots(3, 7, 0, 1, Closure::closed);
    EXPECT_EQ(k.control_count(), 10);
    EXPECT_EQ(k.free_count(), 7);
    EXPECT_DOUBLE_EQ(k.begin(), 0);
    EXPECT_DOUBLE_EQ(k.end(), 1);
    EXPECT_NEAR(k.wrapped(1.25), 0.25, 1e-15);
    EXPECT_NEAR(k.wrapped(-0.25), 0.75, 1e-15);
}

TEST(Knots, span_at_the_ends_has_length) {
    const KnotVector k = uniform_knots(3, 6, 0, 3);
    EXPECT_EQ(k.span(0), 3);
    EXPECT_EQ(k.span(3), 5);
    EXPECT_EQ(k.span(-1), 3);
    EXPECT_EQ(k.span(4), 5);
    EXPECT_EQ(k.span(1), 4);
}

TEST(Knots, refuse_what_breaks_a_rule) {
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(3, {0, 0, 0, 0, 1, 1, 1});
              }),
              "degree 3 needs at least 4 control points, 7 knots make 3");
    EXPECT_EQ(message_of<InvalidInput>([] { KnotVector(10, std::vector<double>(30, 0)); }),
              "degree 10 is outside 1 to 9");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(1, {0, 0, 0.7, 0.5, 1, 1});
              }),
              "knots must ascend: knot 3 = 0.5 is less than knot 2 = 0.7");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(1, {0, 0, NAN, 1, 1});
              }),
              "knot 2 is not a finite number");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(1, {0, 0, 0, 0});
              }),
              "the knots' domain [0, 0] has no length");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(1, {0, 0, 0.5, 0.5, 1, 1});
              }),
              "knot 2 = 0.5 has a multiplicity above the degree 1: the spline would break there");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  KnotVector(1, {-0.5, 0, 0.25, 1, 1.5}, Closure::closed);
              }),
              "closed axis: knot 2 = 0.25 must be knot 0 + the period = 0.5");
    EXPECT_EQ(message_of<InvalidInput>([] {
                  knots_from_parameters(std::vector<double>{0, 1, 2}, 1, 5);
              }),
              "5 control points need at least as many samples, got 3");
    EXPECT_EQ(message_of<InvalidInput>([] { uniform_knots(3, 3, 0, 1); }),
              "degree 3 needs at least 4 control points, got 3");
}

} // namespace
} // namespace batten
