#include <batten/solve/extreme_eigenvalues.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace batten {

namespace {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
}

void subtract(Vector& y, double factor, const Vector& x) {
    for (std::size_t k = 0; k < y.size(); ++k) y[k] -= factor * x[k];
}

/// M times a fixed random vector, normalised: a start without components in the null space.
Vector start_vector(const VectorOperator& matrix, Index size) {
    std::mt19937_64 random(20041970);
    std::normal_distribution<double> normal;
    Vector x(static_cast<std::size_t>(size));
    for (double& value : x) value = normal(random);
    Vector y(x.size());
    matrix(x, y);
    const double length = std::sqrt(dot(y, y));
    if (length > 0)
        for (double& value : y) value /= length;
    return y;
}

/// Ritz values and whether both extreme ones are within tolerance, by the residual |beta s_k|: its
/// square over the gap to the neighbouring Ritz value bounds the error.
struct Ritz {
    ExtremeEigenvalues values;
    bool settled;
};

Ritz ritz(const Vector& alpha, const Vector& beta, double tolerance) {
    const auto k = static_cast<Eigen::Index>(alpha.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    const Eigen::Map<const Eigen::VectorXd> diagonal(alpha.data(), k);
    const Eigen::Map<const Eigen::VectorXd> off(beta.data(), std::max<Eigen::Index>(0, k - 1));
    solver.computeFromTridiagonal(diagonal, off);
    const auto& value = solver.eigenvalues();
    const auto error = [&](Eigen::Index at, Eigen::Index neighbour) {
        const double residual = beta.back() * std::abs(solver.eigenvectors()(k - 1, at));
        const double gap = std::abs(value[at] - value[neighbour]);
        return std::min(residual, gap > 0 ? residual * residual / gap : residual);
    };
    const bool settled = k > 2 && error(0, 1) <= 0.1 * tolerance * std::abs(value[0]) &&
                         error(k - 1, k - 2) <= 0.1 * tolerance * value[k - 1];
    return {{value[k - 1], value[0]}, settled};
}

} // namespace

ExtremeEigenvalues lanczos(const VectorOperator& matrix, Index size, double tolerance) {
    constexpr Index most_steps = 600;
    std::vector<Vector> basis{start_vector(matrix, size)};
    Vector alpha;
    Vector beta;
    Vector w(basis[0].size());
    Ritz now{{0, 0}, false};
    for (Index k = 0; k < std::min(size, most_steps); ++k) {
        const Vector& q = basis.back();
        matrix(q, w);
        alpha.push_back(dot(q, w));
        for (int pass = 0; pass < 2; ++pass) // twice is enough for full orthogonality
            for (const Vector& other : basis) subtract(w, dot(other, w), other);
        beta.push_back(std::sqrt(dot(w, w)));
        const bool exhausted = beta.back() <= 1e-13 * std::abs(alpha[0]) || k + 1 == size;
        if (exhausted) beta.back() = 0;
        if (exhausted || k % 5 == 4) now = ritz(alpha, beta, tolerance);
        if (exhausted || now.settled) break;
        basis.push_back(w);
        for (double& value : basis.back()) value /= beta.back();
    }
    return now.values;
}

ExtremeEigenvalues extreme_eigenvalues(const NormalSystem& system, double tolerance) {
    const auto factors = system.factors();
    if (factors.empty()) {
        PointSet x(system.size(), 1);
        PointSet y(system.size(), 1);
        const VectorOperator whole = [&](const Vector& in, Vector& out) {
            x.values() = in;
            system.apply(x, y);
            out = y.values();
        };
        return lanczos(whole, system.size(), tolerance);
    }
    ExtremeEigenvalues product{1, 1};
    for (const BandedMatrix* gram : factors) {
        const VectorOperator one = [&](const Vector& in, Vector& out) {
            gram->apply(in.data(), out.data(), {});
        };
        const ExtremeEigenvalues e =
            lanczos(one, gram->size(), tolerance / static_cast<double>(factors.size()));
        product.largest *= e.largest;
        product.smallest *= e.smallest;
    }
    return product;
}

} // namespace batten
