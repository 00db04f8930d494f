#include <batten/iterate/convergence_rate.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

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

/// What these show of the slowest direction, and by how much it fails to be an eigenvalue's own.
struct Slowest {
    double rate;
    double residual;
    Vector direction;
};

Slowest slowest_of(const Krylov& krylov, double weight) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(krylov.h);
    Eigen::Index at = 0;
    const double rate = (1.0 - weight * solver.eigenvalues().array()).abs().maxCoeff(&at);
    const Eigen::VectorXcd y = solver.eigenvectors().col(at).normalized();
    Slowest now{rate, weight * krylov.beta * std::abs(y[y.size() - 1]), Vector(krylov.q[0].size())};
    for (std::size_t i = 0; i < krylov.q.size(); ++i)
        add(now.direction, y[static_cast<Eigen::Index>(i)].real(), krylov.q[i]);
    return now;
}

} // namespace

double convergence_rate(const VectorOperator& b, double weight, Vector start, RateEffort effort) {
    constexpr Index most_numbers = 30'000'000; // held at once
    constexpr double settled = 1e-9;
    const auto size = static_cast<Index>(start.size());
    const Index steps =
        std::min({size, effort.directions, std::max<Index>(10, most_numbers / size)});
    double rate = 0;
    for (int round = 0; round < effort.restarts; ++round) {
        normalise(start);
        Slowest now = slowest_of(arnoldi(b, std::move(start), steps), weight);
        rate = now.rate;
        if (now.residual <= settled) break;
        start = std::move(now.direction);
    }
    return rate;
}

} // namespace batten
