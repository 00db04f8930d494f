#include "problems.hpp"

#include <batten/iterate/clspia.hpp>
#include <batten/solve/direct.hpp>

#include <limits>

namespace batten {
namespace {

/// A rose of 30 control points that must hit four of its samples.
struct Held {
    Samples rose = generate("rose");
    Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    std::vector<KnotVector> axes{knots_from_parameters(t.axes[0], 3, 30)};
    std::unique_ptr<NormalSystem> system = assemble(axes, rose, t);
    std::vector<Index> exact{0, 120, 310, 500};
    Constraints constraints = interpolate_samples(axes, rose, t, exact).centred(system->centre());

    /// Largest distance of the spline from the samples that it must hit.
    double largest_miss(const PointSet& control) const {
        const Spline spline = Spline::from_free(axes, uncentred(control, system->centre()));
        double largest = 0;
        for (Index i : exact) {
            const std::vector<double> at =
                spline(std::array{t.axes[0][static_cast<std::size_t>(i)]});
            largest = std::max(largest, distance(at, rose.points[i]));
        }
        return largest;
    }
};

TEST(Clspia, does_not_converge_before_its_samples_are_hit) {
    const Held held;
    const double exactness = 1e-9;
    // tests that hold at once: each alone would end with samples far off
    for (const StopRule& stop : {StopRule{.max_iterations = 100000, .relative_gradient = 0.5},
                                 StopRule{.max_iterations = 100000, .gradient = 1e6},
                                 StopRule{.max_iterations = 100000, .deviation = 1e6}}) {
        Clspia method(*held.system, held.constraints, exactness);
        PointSet control(30, 2);
        const Summary summary =
            iterate(method, control, stop, {.deviation = [](const PointSet&) { return 1.0; }});
        EXPECT_EQ(summary.termination, Termination::converged);
        EXPECT_LE(held.largest_miss(control), exactness * (1 + 1e-6));
        EXPECT_GT(summary.iterations, 10);
    }
    Clspia method(*held.system, held.constraints, exactness);
    PointSet control(30, 2);
    const Summary cut = iterate(method, control, {.max_iterations = 20, .relative_gradient = 0.9});
    EXPECT_EQ(cut.termination, Termination::iteration_limit);
    EXPECT_TRUE(cut.held.relative_gradient); // which was not enough
    EXPECT_GT(held.largest_miss(control), exactness);
}

TEST(Clspia, is_judged_relative_to_the_data_and_not_to_its_start_multipliers) {
    const Held held;
    // at the least-squares optimum A^T (Q - AP) = 0: all that is left is what the samples lack
    PointSet control = solve_direct(*held.system, Constraints(2));
    Clspia method(*held.system, held.constraints, 1e-9, {.lambda = 1});
    PointSet miss = held.constraints.apply(control);
    add_scaled(miss, -1, held.constraints.values());
    const Summary summary = iterate(method, control, {.max_iterations = 0});
    EXPECT_NEAR(summary.reference_norm, frobenius_norm(miss), 1e-12);
    EXPECT_GT(summary.first_gradient_norm, 10 * summary.reference_norm); // lambda^0 pulls
    EXPECT_NE(method.note(), "");                                        // in the data's unit
}

TEST(Clspia, refuses_an_exactness_that_is_none) {
    const Held held;
    for (double exactness : {-1.0, std::numeric_limits<double>::infinity()})
        EXPECT_NE(testing::message_of<InvalidInput>(
                      [&] { Clspia(*held.system, held.constraints, exactness); }),
                  "");
}

} // namespace
} // namespace batten
