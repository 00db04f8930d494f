#include "problems.hpp"

#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>

#include <algorithm>
#include <array>

namespace batten {
namespace {

using testing::message_of;
using testing::random_points;

/// Samples of the rose, their parameters, the system and its dense counterpart.
struct Rose {
    explicit Rose(Index n)
        : samples(generate("rose")),
          parameters(parametrize(samples, Parametrization::chord, {Closure::open})),
          axes{knots_from_parameters(parameters.axes[0], 3, n)},
          system(assemble(axes, samples, parameters)) {}

    reference::Matrix collocation() const {
        return reference::collocation(axes[0], parameters.axes[0]);
    }
    /// Largest difference of control points relative to the centre from the dense solution.
    double error(const PointSet& control) const {
        return reference::difference(
            reference::least_squares(collocation(), reference::matrix(samples.points)),
            uncentred(control, system->centre()));
    }
    /// Eigenvalues of A^T A, the largest first.
    std::vector<double> eigenvalues() const {
        std::vector<double> result = reference::singular_values(collocation());
        for (double& sigma : result) sigma *= sigma;
        return result;
    }

    Samples samples;
    Parameters parameters;
    std::vector<KnotVector> axes;
    std::unique_ptr<NormalSystem> system;
};

TEST(Iterate, every_method_reaches_the_dense_solution) {
    const Rose rose(40);
    EXPECT_LT(rose.error(solve_direct(*rose.system)), 1e-12);
    int seen = 0;
    for (const MethodEntry& entry : methods()) {
        constexpr std::array others{"auto", "direct", "search",      "pia",
                                    "epia", "clspia", "fairing-pia", "monotone-lspia"};
        if (std::ranges::count(others, entry.name) > 0) continue;
        ++seen;
        PointSet control = random_points(rose.system->size(), 2, 1);
        const auto method = make_method(entry.name, *rose.system, {});
        const Summary summary =
            iterate(*method, control, {.max_iterations = 100000, .relative_gradient = 1e-12});
        EXPECT_EQ(summary.termination, Termination::converged) << entry.name;
        EXPECT_LE(summary.gradient_norm, 1e-12 * summary.first_gradient_norm) << entry.name;
        EXPECT_LT(rose.error(control), 1e-10) << entry.name; // gradient over the least eigenvalue
    }
    EXPECT_GE(seen, 10);
}

TEST(Iterate, rates_are_those_of_the_theory) {
    const Rose rose(50);
    const std::vector<double> sigma2 = rose.eigenvalues();
    const double least = sigma2.back();
    const double most = sigma2.front();
    PointSet control(50, 2);
    Lspia lspia(*rose.system, {}, 1e-12);
    const Summary slow = iterate(lspia, control, {});
    const double rate = (most - least) / (most + least); // of the best step
    EXPECT_NEAR(lspia.predicted_rate(), rate, 1e-10);
    EXPECT_NEAR(slow.observed_rate, rate, 2e-3); // the slowest mode has not taken over entirely
    control = PointSet(50, 2);
    Mlspia mlspia(*rose.system, {}, 1e-12);
    const Summary fast = iterate(mlspia, control, {});
    const double s1 = std::sqrt(most);
    const double sr = std::sqrt(least);
    EXPECT_NEAR(mlspia.settings()["omega"], 4 * s1 * sr / ((s1 + sr) * (s1 + sr)), 1e-10);
    EXPECT_NEAR(mlspia.predicted_rate(), (s1 - sr) / (s1 + sr),
                1e-7); // double roots: half the digits
    // the double roots bring a factor of the iteration's number: slower than the rate, at first
    EXPECT_NEAR(fast.observed_rate, (s1 - sr) / (s1 + sr), 0.05);
}

TEST(Iterate, weights_outside_the_convergence_region_are_refused) {
    const Rose rose(50);
    const NormalSystem* system = rose.system.get();
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

/// Spectral radius of MLSPIA's iteration [HuangWang2020, eq. 1 to 3] as a dense matrix on the error
/// e^k, the last moves D^{k-1} and the last gradients d^{k-1}: d^k = nu A^T A e^k, D^k = (1 -
/// omega) D^{k-1} + gamma d^k + (omega - gamma) d^{k-1}, e^{k+1} = e^k - D^k.
double mlspia_radius(const reference::Matrix& a, double omega, double gamma, double nu) {
    const Index n = a.cols();
    const reference::Matrix g = nu * reference::transposed_product(a, a);
    const reference::Matrix one = reference::Matrix::Identity(n, n);
    reference::Matrix step = reference::Matrix::Zero(3 * n, 3 * n);
    step.block(n, 0, n, n) = gamma * g;
    step.block(n, n, n, n) = (1 - omega) * one;
    step.block(n, 2 * n, n, n) = (omega - gamma) * one;
    step.topRows(n) = -step.middleRows(n, n);
    step.topLeftCorner(n, n) += one;
    step.block(2 * n, 0, n, n) = g;
    return reference::spectral_radius(step);
}

TEST(Iterate, gamma_inside_the_region_converges_and_outside_would_not) {
    // the region of eq. 11 is sharp: just inside it converges
    const Rose rose(30);
    const reference::Matrix a = rose.collocation();
    const double sigma2 = rose.eigenvalues()[0];
    const double omega = 1;
    const double nu = 1 / sigma2;
    const double high = omega / 2 - (omega - 2) / (sigma2 * nu);
    PointSet control(30, 2);
    Mlspia inside(*rose.system, {omega, 0.98 * high, nu}, 1e-12);
    EXPECT_LT(mlspia_radius(a, omega, 0.98 * high, nu), 1);
    EXPECT_EQ(
        iterate(inside, control, {.max_iterations = 200000, .relative_gradient = 1e-8}).termination,
        Termination::converged);
    EXPECT_LT(rose.error(control), 1e-6);
    Mlspia outside(*rose.system, {omega, 1.02 * high, nu}, 1e-12);
    EXPECT_GT(mlspia_radius(a, omega, 1.02 * high, nu), 1);
    EXPECT_TRUE(
        message_of<InvalidInput>([&] { outside.start(control); }).starts_with("setting gamma = "));
}

TEST(Iterate, mlspia_converges_from_any_lambda) {
    const Rose rose(30);
    Mlspia method(*rose.system);
    method.set_first_moves(random_points(30, 2, 77)); // A^T Lambda^0 of an arbitrary Lambda^0
    PointSet control = random_points(30, 2, 78);
    EXPECT_EQ(iterate(method, control, {.relative_gradient = 1e-12}).termination,
              Termination::converged);
    EXPECT_LT(rose.error(control), 1e-10);
}

TEST(Iterate, an_observer_sees_every_iteration_and_can_stop) {
    const Rose rose(30);
    const NormalSystem* system = rose.system.get();
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
    const Rose rose(30);
    const NormalSystem* system = rose.system.get();
    PointSet control(30, 2);
    Mlspia method(*system);
    EXPECT_EQ(iterate(method, control, {.max_iterations = 3}).termination,
              Termination::iteration_limit);
    Index asked = 0;
    const auto measure = [&](const PointSet&) { return ++asked < 4 ? 1.0 : 0.1; };
    Mlspia again(*system);
    control = PointSet(30, 2);
    const Summary close =
        iterate(again, control, {.relative_gradient = 0, .deviation = 0.5}, {{}, {}, measure});
    EXPECT_EQ(close.iterations, 3);
    EXPECT_EQ(close.termination, Termination::converged);
    ConjugateGradients cg(*system);
    control = PointSet(30, 2);
    const Summary summary = iterate(cg, control, {.relative_gradient = 0});
    EXPECT_EQ(summary.termination, Termination::stalled);
    EXPECT_LT(summary.iterations, 200);
    EXPECT_LT(rose.error(control), 1e-12); // nothing but rounding is left
}

TEST(Iterate, limited_moves_are_the_ones_remembered) {
    // a limit that halves every move: conjugacy is lost, yet the solution is reached
    const Rose rose(30);
    const StepLimit half = [](const PointSet&, PointSet& moves) {
        for (double& x : moves.values()) x /= 2;
    };
    for (const char* name : {"lspia", "cg"}) {
        PointSet control(30, 2);
        const auto method = make_method(name, *rose.system, {});
        iterate(*method, control, {.max_iterations = 5000, .relative_gradient = 1e-12},
                {{}, half, {}});
        EXPECT_LT(rose.error(control), 1e-9) << name;
    }
}

} // namespace
} // namespace batten
