#include "problems.hpp"

#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>

namespace batten {
namespace {

using testing::largest_difference;
using testing::message_of;
using testing::random_points;

std::unique_ptr<NormalSystem> rose_system(Index n) {
    const Samples rose = generate("rose");
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    return assemble({knots_from_parameters(t.axes[0], 3, n)}, rose, t);
}

TEST(Iterate, every_method_reaches_the_direct_solution) {
    const auto system = rose_system(40);
    const PointSet direct = solve_direct(*system);
    for (const MethodEntry& entry : methods()) {
        if (entry.name == "auto" || entry.name == "direct" ||
            entry.name.ends_with("pia") != (entry.name == "lspia" || entry.name == "mlspia"))
            continue;
        PointSet control = random_points(system->size(), 2, 1);
        const auto method = make_method(entry.name, *system, {});
        const Summary summary =
            iterate(*method, control, {.max_iterations = 100000, .relative_gradient = 1e-13});
        EXPECT_TRUE(summary.termination == Termination::converged ||
                    summary.termination == Termination::stalled)
            << entry.name;
        EXPECT_LT(largest_difference(control, direct), 1e-11)
            << entry.name; // gradient over the smallest eigenvalue
    }
}

TEST(Iterate, rates_are_those_of_the_theory) {
    const auto system = rose_system(50);
    PointSet control(50, 2);
    Lspia lspia(*system, {}, 1e-12);
    const Summary slow = iterate(lspia, control, {});
    EXPECT_NEAR(slow.observed_rate, lspia.predicted_rate(),
                2e-3); // the slowest mode has not taken over entirely
    control = PointSet(50, 2);
    Mlspia mlspia(*system, {}, 1e-12);
    iterate(mlspia, control, {});
    EXPECT_NEAR(mlspia.predicted_rate(), std::sqrt(1 - mlspia.settings()["omega"]),
                1e-7); // double roots: half the digits
}

TEST(Iterate, weights_outside_the_convergence_region_are_refused) {
    const auto system = rose_system(50);
    PointSet control(50, 2);
    const auto refusal = [&](std::string_view name, Settings settings) {
        return message_of<InvalidInput>(
            [&] { make_method(name, *system, settings)->start(control); });
    };
    EXPECT_EQ(refusal("mlspia", {{"omega", 2.5}}),
              "setting omega = 2.5 of method mlspia is outside 0 < omega < 2");
    EXPECT_EQ(refusal("mlspia", {{"nu", -1}}),
              "setting nu = -1 of method mlspia is outside 0 < nu");
    EXPECT_TRUE(refusal("mlspia", {{"gamma", 5}, {"nu", 1}})
                    .starts_with("setting gamma = 5 of method mlspia is outside "));
    EXPECT_TRUE(refusal("lspia", {{"mu", 10}})
                    .starts_with("setting mu = 10 of method lspia is outside 0 < mu < "));
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  make_method("mlspia", *system, {{"omgea", 1}});
              }),
              "unknown setting of method mlspia 'omgea'; did you mean 'omega'?");
    EXPECT_EQ(message_of<InvalidInput>([] { method_entry("mlspai"); }),
              "unknown method 'mlspai'; did you mean 'mlspia'?");
}

TEST(Iterate, gamma_inside_the_region_converges_and_outside_would_not) {
    // the region of eq. 11 is sharp: just inside it converges
    const auto system = rose_system(30);
    const double sigma2 = extreme_eigenvalues(*system, 1e-12).largest;
    const double omega = 1, nu = 1 / sigma2;
    const double high = omega / 2 - (omega - 2) / (sigma2 * nu);
    PointSet control(30, 2);
    Mlspia inside(*system, {omega, 0.98 * high, nu}, 1e-12);
    EXPECT_EQ(
        iterate(inside, control, {.max_iterations = 200000, .relative_gradient = 1e-8}).termination,
        Termination::converged);
    Mlspia outside(*system, {omega, 1.02 * high, nu}, 1e-12);
    EXPECT_NE(message_of<InvalidInput>([&] { outside.start(control); }), "");
}

TEST(Iterate, mlspia_converges_from_any_lambda) {
    const auto system = rose_system(30);
    const PointSet direct = solve_direct(*system);
    Mlspia method(*system);
    method.set_first_moves(random_points(30, 2, 77)); // A^T Lambda^0 of an arbitrary Lambda^0
    PointSet control = random_points(30, 2, 78);
    EXPECT_EQ(iterate(method, control, {.relative_gradient = 1e-12}).termination,
              Termination::converged);
    EXPECT_LT(largest_difference(control, direct), 1e-10);
}

TEST(Iterate, an_observer_sees_every_iteration_and_can_stop) {
    const auto system = rose_system(30);
    PointSet control(30, 2);
    Index seen = 0;
    Mlspia method(*system);
    const Summary summary = iterate(method, control, {},
                                    {[&](const Iteration& now) {
                                         EXPECT_EQ(now.number, seen);
                                         return ++seen == 5 ? Continue::no : Continue::yes;
                                     },
                                     {},
                                     {}});
    EXPECT_EQ(summary.termination, Termination::cancelled);
    EXPECT_EQ(summary.iterations, 4);
}

TEST(Iterate, stops_for_its_limit_its_deviation_and_rounding) {
    const auto system = rose_system(30);
    PointSet control(30, 2);
    Mlspia method(*system);
    EXPECT_EQ(iterate(method, control, {.max_iterations = 3}).termination,
              Termination::iteration_limit);
    Index asked = 0;
    const auto measure = [&](const PointSet&) { return ++asked < 4 ? 1.0 : 0.1; };
    Mlspia again(*system);
    control = PointSet(30, 2);
    EXPECT_EQ(iterate(again, control, {.relative_gradient = 0, .deviation = 0.5}, {{}, {}, measure})
                  .iterations,
              3);
    ConjugateGradients cg(*system);
    control = PointSet(30, 2);
    const Summary summary = iterate(cg, control, {.relative_gradient = 0});
    EXPECT_EQ(summary.termination, Termination::stalled);
    EXPECT_LT(summary.iterations, 200);
}

TEST(Iterate, limited_moves_are_the_ones_remembered) {
    // a limit that halves every move: conjugacy is lost, yet the solution is reached
    const auto system = rose_system(30);
    const PointSet direct = solve_direct(*system);
    const StepLimit half = [](const PointSet&, PointSet& moves) {
        for (double& x : moves.values()) x /= 2;
    };
    for (const char* name : {"lspia", "cg"}) {
        PointSet control(30, 2);
        const auto method = make_method(name, *system, {});
        iterate(*method, control, {.max_iterations = 5000, .relative_gradient = 1e-12},
                {{}, half, {}});
        EXPECT_LT(largest_difference(control, direct), 1e-9) << name;
    }
}

} // namespace
} // namespace batten
