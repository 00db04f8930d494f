#include <batten/iterate/convergence_rate.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace batten {

namespace {

using Vector = std::vector<double>;

double norm(const Vector& x) {
    double sum = 0;
    for (double value : x) sum += value * value;
    return std::sqrt(sum);
}

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
}

void add(Vector& y, double factor, const Vector& x) {
    for (std::size_t k = 0; k < y.size(); ++k) y[k] += factor * x[k];
}

void normalise(Vector& x) {
    const double length = norm(x);
    for (double& value : x) value /= length;
}

Vector image_of(const VectorOperator& b, const Vector& x) {
    Vector y(x.size());
    b(x, y);
    return y;
}

/// Orthonormal directions Q and the matrix H of B on them, B Q = Q H + beta q e^T.
struct Krylov {
    std::vector<Vector> q;
    Eigen::MatrixXd h;
    double beta;
};

Krylov arnoldi(const VectorOperator& b, Vector start, Index steps) {
    Krylov result{{std::move(start)}, Eigen::MatrixXd::Zero(steps, steps), 0};
    for (Index k = 0; k < steps; ++k) {
        Vector w = image_of(b, result.q.back());
        const double whole = norm(w);
        for (int pass = 0; pass < 2; ++pass) // twice is enough for orthogonality
            for (Index i = 0; i <= k; ++i) {
                const double along = dot(result.q[static_cast<std::size_t>(i)], w);
                result.h(i, k) += along;
                add(w, -along, result.q[static_cast<std::size_t>(i)]);
            }
        result.beta = norm(w);
        if (result.beta <= 1e-13 * whole || k + 1 == steps) {
            if (result.beta <= 1e-13 * whole) result.beta = 0;
            result.h.conservativeResize(k + 1, k + 1);
            break;
        }
        result.h(k + 1, k) = result.beta;
        for (double& value : w) value /= result.beta;
        result.q.push_back(std::move(w));
    }
    return result;
}

/// The rate that these show, and a sum of the slowest directions to go on from.
struct Slowest {
    ConvergenceRate rate;
    Vector direction;
};

/// Of one eigenvalue: one over the cosine between its left and right eigenvectors.
double condition(const Eigen::EigenSolver<Eigen::MatrixXd>& solver, Eigen::Index which) {
    const Eigen::MatrixXcd right = solver.eigenvectors();
    const Eigen::VectorXcd unit = Eigen::VectorXcd::Unit(right.rows(), which);
    const Eigen::VectorXcd left = right.adjoint().partialPivLu().solve(unit);
    const double product = left.norm() * right.col(which).norm();
    return std::isfinite(product) ? product : 1e300;
}

/// How far an eigenvalue is from the truth by its direction's residual: the square of that over the
/// gap to the next where this is less [GolubVanLoan2013, section 8.1].
double tightened(const Eigen::EigenSolver<Eigen::MatrixXd>& solver, Eigen::Index which,
                 double residual, double weight) {
    double gap = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < solver.eigenvalues().size(); ++k)
        if (k != which)
            gap = std::min(
                gap, weight * std::abs(solver.eigenvalues()[k] - solver.eigenvalues()[which]));
    return gap > 0 ? std::min(residual, residual * residual / gap) : residual;
}

Slowest slowest_of(const Krylov& krylov, double weight) {
    constexpr std::size_t most_summed = 6;
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(krylov.h);
    const Eigen::ArrayXd rates = (1.0 - weight * solver.eigenvalues().array()).abs();
    std::vector<Eigen::Index> order(krylov.q.size());
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::sort(order, [&](Eigen::Index i, Eigen::Index j) { return rates[i] > rates[j]; });
    order.resize(std::min(order.size(), most_summed));
    const double certain = std::numeric_limits<double>::epsilon();
    Slowest now{{rates[order[0]], certain, solver.eigenvalues()[order[0]]},
                Vector(krylov.q[0].size())};
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(krylov.h.rows());
    for (Eigen::Index k : order) {
        const Eigen::VectorXcd direction = solver.eigenvectors().col(k).normalized();
        const double residual = weight * krylov.beta * std::abs(direction[direction.size() - 1]);
        const double off =
            k == order[0] ? residual * condition(solver, k)
                          : rates[k] + tightened(solver, k, residual, weight) - rates[order[0]];
        now.rate.accuracy = std::max(now.rate.accuracy, std::min(1.0, off));
        sum += direction.real();
    }
    for (std::size_t i = 0; i < krylov.q.size(); ++i)
        add(now.direction, sum[static_cast<Eigen::Index>(i)], krylov.q[i]);
    return now;
}

} // namespace

ConvergenceRate convergence_rate(const VectorOperator& b, double weight, Vector start,
                                 RateEffort effort) {
    constexpr Index most_numbers = 30'000'000; // held at once
    constexpr double settled = 1e-9;
    const auto size = static_cast<Index>(start.size());
    const Index steps =
        std::min({size, effort.directions, std::max<Index>(10, most_numbers / size)});
    ConvergenceRate rate;
    for (int round = 0; round < effort.restarts; ++round) {
        normalise(start);
        Slowest now = slowest_of(arnoldi(b, std::move(start), steps), weight);
        rate = now.rate;
        if (rate.accuracy <= settled) break;
        start = std::move(now.direction);
    }
    return rate;
}

namespace {

/// The w > 0 for which the largest |1 - w theta| is least, a convex function; all of them with a
/// positive real part.
double level_weight(const std::vector<std::complex<double>>& thetas) {
    const auto largest = [&](double w) {
        double most = 0;
        for (const auto& theta : thetas) most = std::max(most, std::abs(1.0 - w * theta));
        return most;
    };
    double low = 0;
    double high = 0; // each alone is best below one over its real part
    for (const auto& theta : thetas) high = std::max(high, 1 / theta.real());
    for (int k = 0; k < 200; ++k) {
        const double a = low + (high - low) / 3;
        const double b = high - (high - low) / 3;
        (largest(a) < largest(b) ? high : low) = largest(a) < largest(b) ? b : a;
    }
    return (low + high) / 2;
}

} // namespace

double best_weight(const VectorOperator& b, const Vector& start, RateEffort effort,
                   std::vector<std::complex<double>> known) {
    constexpr int most_exchanges = 12;
    constexpr double level = 1e-9;
    std::vector<std::complex<double>>& thetas = known;
    double weight = 1;
    double bound = 0;
    for (int k = 0; k < most_exchanges; ++k) {
        const ConvergenceRate now = convergence_rate(b, weight, start, effort);
        if (k > 0 && now.value <= bound + level + now.accuracy) break;
        if (!(now.eigenvalue.real() > 0)) return 1;
        thetas.push_back(now.eigenvalue);
        weight = level_weight(thetas);
        bound = 0;
        for (const auto& theta : thetas) bound = std::max(bound, std::abs(1.0 - weight * theta));
    }
    return weight;
}

} // namespace batten
