#include <batten/measure/net_descent.hpp>

#include <batten/measure/net_model.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace batten {

namespace {

/// Cholesky's solution over the free axes (zero elsewhere); nothing when the matrix, of which the
/// lower half is read, is not positive definite.
std::optional<PerAxis<double>> solve(AxisMatrix a, const PerAxis<bool>& free, PerAxis<double> x) {
    for (std::size_t j = 0; j < 3; ++j) { // a fixed axis becomes the equation x = 0
        if (free[j]) continue;
        for (std::size_t k = 0; k < 3; ++k) a[j][k] = a[k][j] = 0;
        a[j][j] = 1;
        x[j] = 0;
    }
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 0)) return std::nullopt;
        a[j][j] = std::sqrt(a[j][j]);
        for (std::size_t i = j + 1; i < 3; ++i) {
            for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t k = 0; k < j; ++k) x[j] -= a[j][k] * x[k];
        x[j] /= a[j][j];
    }
    for (std::size_t j = 3; j-- > 0;) {
        for (std::size_t k = j + 1; k < 3; ++k) x[j] -= a[k][j] * x[k];
        x[j] /= a[j][j];
    }
    return x;
}

/// Newton's step downhill; without the net's bend where the Hessian is not positive definite.
PerAxis<double> downhill_step(const NetModel& model, const PerAxis<int>& degrees,
                              const PerAxis<double>& at) {
    PerAxis<bool> free{};
    PerAxis<double> downhill{};
    AxisMatrix damped = model.without_bend;
    double trace = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        downhill[a] = -model.gradient[a];
        free[a] = degrees[a] > 0 && !(at[a] <= 0 && downhill[a] <= 0) &&
                  !(at[a] >= 1 && downhill[a] >= 0);
        if (free[a]) trace += damped[a][a];
    }
    if (const auto newton = solve(model.hessian, free, downhill)) return *newton;
    constexpr double damping = 1e-12; // of what cannot be told from rounding
    for (std::size_t a = 0; a < 3; ++a) damped[a][a] += damping * trace;
    return solve(damped, free, downhill).value_or(PerAxis<double>{});
}

PerAxis<double> moved(const PerAxis<double>& at, const PerAxis<double>& step, double part) {
    PerAxis<double> to{};
    for (std::size_t a = 0; a < 3; ++a) to[a] = std::clamp(at[a] + part * step[a], 0.0, 1.0);
    return to;
}

double length(const PerAxis<double>& step) {
    return std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2])});
}

/// Newton's step from a place, and what it promises.
struct Plan {
    PerAxis<double> step{};
    double gain = 0;
};

Plan plan_from(const NetModel& model, const PerAxis<int>& degrees, const PerAxis<double>& at) {
    Plan plan{.step = downhill_step(model, degrees, at)};
    for (std::size_t a = 0; a < 3; ++a) plan.gain -= plan.step[a] * model.gradient[a];
    return plan;
}

} // namespace

Descent descend(const BezierNet& net, Index axis_count, Index dim, const PerAxis<double>& start,
                int steps) {
    constexpr int most_halvings = 10;
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    constexpr double least_step = 1e-14; // of the net's parameters
    PerAxis<double> at = start;
    NetModel here = model_at(net, axis_count, dim, at);
    for (int k = 0;; ++k) {
        const auto [step, gain] = plan_from(here, net.degrees, at);
        const Descent now{at, here.square, gain};
        if (k == steps || !(gain > 0) || length(step) < least_step) return now;
        // a gain that rounding hides is not looked for twice
        const int halvings = gain > 4 * epsilon * here.square ? most_halvings : 0;
        double part = 1;
        for (int halving = 0;; ++halving, part /= 2) {
            const PerAxis<double> next = moved(at, step, part);
            const NetModel there = model_at(net, axis_count, dim, next);
            if (there.square < here.square) {
                at = next;
                here = there;
                break;
            }
            if (halving == halvings) return now;
        }
    }
}

} // namespace batten
