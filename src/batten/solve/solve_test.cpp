#include "problems.hpp"

#include <batten/solve/banded_cholesky.hpp>
#include <batten/solve/sample_rows.hpp>
#include <batten/system/collocation.hpp>

namespace batten {
namespace {

using testing::largest_difference;
using testing::message_of;
using testing::random_parameters;
using testing::random_points;

reference::Matrix dense(const BandedMatrix& m) {
    reference::Matrix result = reference::Matrix::Zero(m.size(), m.size());
    for (Index i = 0; i < m.size(); ++i)
        for (int k = 0; k <= m.bandwidth(); ++k) {
            const Index j = (i + k) % m.size();
            if (i + k >= m.size() && m.closure() == Closure::open) continue;
            result(i, j) += m.at(i, k);
            if (k > 0) result(j, i) += m.at(i, k);
        }
    return result;
}

std::unique_ptr<NormalSystem> curve_system(int degree, Index n, Closure closure, Index m = 200) {
    const auto t = random_parameters(m, 21);
    return assemble({uniform_knots(degree, n, 0, 1, closure)},
                    testing::sequence(random_points(m, 2, 22)), {{t}, {}});
}

TEST(BandedCholesky, solves_open_and_closed_systems_of_every_size) {
    for (Closure closure : {Closure::open, Closure::closed})
        for (int p : {1, 3, 6})
            for (Index n :
                 {Index{p + 1}, Index{p + 2}, Index{2 * p}, Index{2 * p + 3}, Index{40}}) {
                if (n < p + 1) continue;
                const auto system = curve_system(p, n, closure);
                const BandedMatrix& m = *system->factors()[0];
                const PointSet b = random_points(n, 3, 5);
                PointSet x = b;
                BandedCholesky(m).solve(x.data(), {1, 3});
                PointSet back(n, 3);
                m.apply(x.data(), back.data(), {1, 3});
                EXPECT_LT(largest_difference(back, b), 1e-9)
                    << p << " " << n; // condition up to 1e5
                EXPECT_LT(
                    reference::difference(reference::product(dense(m), reference::matrix(x)), b),
                    1e-9);
            }
}

TEST(BandedCholesky, names_the_control_point_that_no_sample_determines) {
    BandedMatrix m(4, 1, Closure::open);
    for (Index i : {0, 1, 3}) m.at(i, 0) = 2;
    EXPECT_EQ(
        message_of<SolverError>([&] { BandedCholesky c(m); }),
        "the normal equations are singular: control point 2 is not determined by the samples");
}

TEST(Direct, leaves_a_residual_orthogonal_to_every_b_spline) {
    const auto t = random_parameters(300, 1);
    const PointSet q = random_points(300, 3, 2);
    for (Closure closure : {Closure::open, Closure::closed}) {
        const KnotVector k = knots_from_parameters(t, 3, 25, closure);
        const auto system = assemble({k}, testing::sequence(q), {{t}, {}});
        const PointSet p = uncentred(solve_direct(*system), system->centre());
        const reference::Matrix a = reference::collocation(k, t);
        const reference::Matrix points = reference::matrix(q);
        const reference::Matrix residual = points - reference::product(a, reference::matrix(p));
        EXPECT_LT(reference::transposed_product(a, residual).norm(),
                  1e-12L * points.norm()); // A^T (Q - A P) = 0
        EXPECT_LT(reference::difference(reference::least_squares(a, points), p), 1e-11);
    }
}

TEST(Direct, a_grid_is_solved_axis_by_axis) {
    const Samples samples = generate("bent-block", {9, 8, 7});
    const Parameters t =
        parametrize(samples, Parametrization::chord, {Closure::open, Closure::open, Closure::open});
    std::vector<KnotVector> axes;
    const Index n[] = {5, 6, 4};
    for (std::size_t k = 0; k < 3; ++k)
        axes.push_back(knots_from_parameters(t.axes[k], k == 1 ? 2 : 3, n[k]));
    const auto system = assemble(axes, samples, t);
    const PointSet p = solve_direct(*system);
    EXPECT_LT(frobenius_norm(system->gradient(p)), 1e-11 * frobenius_norm(system->rhs()));
    // the same from the dense Kronecker product
    reference::Matrix product = reference::Matrix::Ones(1, 1);
    for (std::size_t k = 0; k < 3; ++k)
        product = reference::kronecker(product, reference::collocation(axes[k], t.axes[k]));
    const reference::Matrix best =
        reference::least_squares(product, reference::matrix(samples.points));
    EXPECT_LT(reference::difference(best, uncentred(p, system->centre())),
              1e-9); // condition of the Gram matrix about 1e4
}

TEST(RowFactorization, joins_long_triangles) {
    // rows of the second chunk rotate in over a thousand columns of the first one's leftovers,
    // which decay below every number
    const Index n = 4000;
    const Index m = 26000;
    const KnotVector knots = uniform_knots(3, n, 0, 1);
    std::vector<double> t;
    PointSet cubes(m, 1);
    for (Index i = 0; i < m; ++i) {
        t.push_back(static_cast<double>(i) / static_cast<double>(m - 1));
        cubes(i, 0) = std::pow(t.back(), 3);
    }
    const Samples samples = testing::sequence(std::move(cubes));
    const Parameters parameters{{t}, {}};
    const PointSet found =
        RowFactorization({knots}, {.samples = samples, .parameters = parameters}, {0}).solution();
    for (Index i = 0; i < n; ++i) // the blossom of the cube
        ASSERT_NEAR(found(i, 0), knots[i + 1] * knots[i + 2] * knots[i + 3], 1e-14) << i;
}

TEST(ExtremeEigenvalues, agree_with_a_dense_singular_value_decomposition) {
    for (Index n : {Index{5}, Index{50}, Index{150}})
        for (double tolerance : {1e-2, 1e-12}) {
            const auto system = curve_system(3, n, Closure::open, 4 * n);
            const auto t = random_parameters(4 * n, 21);
            const KnotVector k = uniform_knots(3, n, 0, 1);
            const std::vector<double> sigma =
                reference::singular_values(reference::collocation(k, t));
            const ExtremeEigenvalues e = extreme_eigenvalues(*system, tolerance);
            const double allowed = std::max(
                tolerance, 1e-10); // squaring the matrix costs half the digits of the smallest
            EXPECT_NEAR(e.largest / (sigma.front() * sigma.front()), 1, allowed);
            EXPECT_NEAR(e.smallest / (sigma.back() * sigma.back()), 1, allowed) << n;
        }
}

TEST(NormalSystem, energy_is_the_sum_of_squares) {
    const auto t = random_parameters(200, 21);
    const auto system = curve_system(3, 12, Closure::open);
    const PointSet p = random_points(12, 2, 3);
    const reference::Matrix residual =
        reference::matrix(random_points(200, 2, 22)) -
        reference::product(reference::collocation(system->axes()[0], t),
                           reference::matrix(uncentred(p, system->centre())));
    EXPECT_NEAR(system->energy(p) + system->data_energy(),
                static_cast<double>(residual.squaredNorm()), 1e-10);
}

TEST(Collocation, names_the_spans_that_lack_samples) {
    const KnotVector k = uniform_knots(3, 13, 0, 1); // ten spans
    std::vector<double> t = random_parameters(200, 9);
    EXPECT_FALSE(undetermined(k, t).has_value());
    std::erase_if(t, [](double x) { return x > 0.2 && x < 0.81; });
    EXPECT_EQ(undetermined(k, t).value(),
              "no samples in knot spans [0.2, 0.3], [0.3, 0.4], [0.4, 0.5], ...");
    const KnotVector closed = uniform_knots(3, 10, 0, 1, Closure::closed);
    EXPECT_TRUE(undetermined(closed, t).has_value());
    EXPECT_FALSE(undetermined(closed, random_parameters(40, 3)).has_value());
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  Collocation(k, std::vector<double>{0, 1.5});
              }),
              "parameter 1 = 1.5 is outside the knots' domain [0, 1]");
}

TEST(Collocation, the_closed_conditions_agree_with_the_rank) {
    // few samples at random places: the rotation test must say what the rank says
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const KnotVector k = uniform_knots(2, 5, 0, 1, Closure::closed);
        std::vector<double> t(5 + static_cast<std::size_t>(trial % 3));
        for (double& x : t)
            x = std::uniform_real_distribution<double>(0, trial % 2 == 0 ? 1.0 : 0.7)(random);
        std::sort(t.begin(), t.end());
        EXPECT_EQ(reference::rank(reference::collocation(k, t), 1e-10) == 5,
                  !undetermined(k, t).has_value())
            << trial;
    }
}

TEST(Directions, get_the_lengths_that_leave_the_least_error) {
    const auto system = curve_system(3, 14, Closure::open);
    const auto& axes = system->axes();
    Constraints constraints(2);
    const std::array first{1};
    constraints.add(axes, std::array{0.3}, {}, std::array{0.2, -0.1}, "point");
    // near the free fit's own directions, so that no length would turn round
    Constraints probe(2);
    for (double t : {0.3, 0.8}) probe.add(axes, std::array{t}, first, std::array{0.0, 0.0}, "");
    const PointSet own = probe.apply(solve_direct(*system));
    const std::array one{own(0, 0) - 0.2 * own(0, 1), own(0, 1) + 0.2 * own(0, 0)};
    const std::array two{own(1, 0) + 0.1 * own(1, 1), own(1, 1) - 0.1 * own(1, 0)};
    constraints.add_direction(axes, std::array{0.3}, first, one, "one");
    constraints.add_direction(axes, std::array{0.8}, first, two, "two");
    const Constraints local = constraints.centred(system->centre());
    const PointSet best = solve_direct(*system, local);
    {
        // both coordinates in one dense problem: a direction says that the cross product vanishes
        const auto t = random_parameters(200, 21);
        const reference::Matrix a = reference::collocation(axes[0], t);
        const reference::Matrix q = reference::matrix(random_points(200, 2, 22));
        reference::Matrix both = reference::Matrix::Zero(400, 28);
        both.topLeftCorner(200, 14) = both.bottomRightCorner(200, 14) = a;
        reference::Matrix right(400, 1);
        right << q.col(0), q.col(1);
        reference::Matrix c = reference::Matrix::Zero(4, 28);
        reference::Matrix d = reference::Matrix::Zero(4, 1);
        c.block(0, 0, 1, 14) = c.block(1, 14, 1, 14) = reference::collocation(axes[0], {0.3});
        d(0) = 0.2L;
        d(1) = -0.1L;
        for (const auto& [row, at, direction] :
             {std::tuple{2, 0.3, one}, std::tuple{3, 0.8, two}}) {
            const reference::Matrix slope = reference::collocation(axes[0], {at}, 1);
            c.block(row, 0, 1, 14) = slope * direction[1];
            c.block(row, 14, 1, 14) = -slope * direction[0];
        }
        const reference::Matrix exact = reference::least_squares(both, right, c, d);
        reference::Matrix planar(14, 2);
        planar << exact.topRows(14), exact.bottomRows(14);
        EXPECT_LT(reference::difference(planar, uncentred(best, system->centre())), 1e-10);
    }
    const PointSet values = local.apply(best);
    EXPECT_NEAR(values(1, 0) * one[1] - values(1, 1) * one[0], 0, 1e-10);
    EXPECT_NEAR(values(2, 0) * two[1] - values(2, 1) * two[0], 0, 1e-10);
    const auto length = [&](Index row, double x, double y) {
        return (values(row, 0) * x + values(row, 1) * y) / std::hypot(x, y);
    };
    const std::array lengths{length(1, one[0], one[1]), length(2, two[0], two[1])};
    const double least = system->energy(best);
    EXPECT_NEAR(system->energy(solve_direct(*system, local.with_lengths(lengths))), least,
                1e-10 * std::abs(least));
    for (std::size_t k : {0U, 1U})
        for (double change : {-0.1, 0.1}) {
            auto other = lengths;
            other[k] += change;
            EXPECT_GT(system->energy(solve_direct(*system, local.with_lengths(other))), least);
        }
}

TEST(Constraints, those_that_follow_from_others_are_dropped) {
    const auto system = curve_system(3, 10, Closure::open);
    const auto& axes = system->axes();
    Constraints constraints(2);
    constraints.add(axes, std::array{0.0}, {}, std::array{0.5, 0.25}, "begin");
    constraints.fix(0, std::array{0.5, 0.25}, "first control point"); // the same of a clamped curve
    EXPECT_EQ(constraints.independent(system->size()).size(), 1);
    Constraints other = constraints;
    other.fix(0, std::array{0.5, 0.26}, "moved");
    EXPECT_EQ(message_of<ConstraintConflict>([&] { other.independent(system->size()); }),
              "constraints contradict each other: begin, moved");
}

TEST(Constraints, give_the_dense_solution_with_equalities) {
    for (Closure closure : {Closure::open, Closure::closed}) {
        const auto system = curve_system(3, 16, closure);
        const auto& axes = system->axes();
        Constraints constraints(2);
        constraints.add(axes, std::array{0.1}, {}, std::array{0.3, -0.2}, "a point");
        constraints.add(axes, std::array{0.6}, {}, std::array{-0.4, 0.5}, "another");
        constraints.add(axes, std::array{0.6}, std::array{1}, std::array{2.0, 1.0}, "a derivative");
        const PointSet found = uncentred(
            solve_direct(*system, constraints.centred(system->centre())), system->centre());
        reference::Matrix c(3, 16);
        c << reference::collocation(axes[0], {0.1, 0.6}), reference::collocation(axes[0], {0.6}, 1);
        reference::Matrix d(3, 2);
        d << 0.3L, -0.2L, -0.4L, 0.5L, 2, 1;
        const reference::Matrix exact =
            reference::least_squares(reference::collocation(axes[0], random_parameters(200, 21)),
                                     reference::matrix(random_points(200, 2, 22)), c, d);
        EXPECT_LT(reference::difference(exact, found), 1e-11);
    }
}

} // namespace
} // namespace batten
