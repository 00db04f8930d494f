#include <batten/solve/extreme_eigenvalues.hpp>

#include <batten/core/vectors.hpp>
#include <batten/solve/banded_cholesky.hpp>
#include <batten/solve/nested_cholesky.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace batten {

namespace {

using Vector = std::vector<double>;

/// M times a fixed random vector: a start without components in the null space.
Vector start_vector(const VectorOperator& matrix, Index size) {
    std::mt19937_64 random(20041970);
    std::normal_distribution<double> normal;
    Vector x(static_cast<std::size_t>(size));
    for (double& value : x) value = normal(random);
    Vector y(x.size());
    matrix(x, y);
    return y;
}

/// Orthonormal directions q of the product <., M^{-1} .> and their images M^{-1} q, which are the
/// same where there is no preconditioner M.
class Basis {
  public:
    explicit Basis(const VectorOperator& preconditioner) : preconditioner_(preconditioner) {}

    const Vector& last_image() const { return (preconditioner_ ? images_ : directions_).back(); }
    /// Takes from w what lies along the directions.
    void make_orthogonal(Vector& w) const {
        const std::vector<Vector>& images = preconditioner_ ? images_ : directions_;
        for (int pass = 0; pass < 2; ++pass) // twice is enough for full orthogonality
            for (std::size_t k = 0; k < directions_.size(); ++k)
                batten::add_scaled(w.data(), -dot(images[k], w), directions_[k].data(),
                                   static_cast<Index>(w.size()));
    }
    double length(const Vector& w) {
        if (!preconditioner_) return norm(w);
        image_.resize(w.size());
        preconditioner_(w, image_);
        return std::sqrt(std::max(0.0, dot(w, image_)));
    }
    /// Adds the w that length() was asked last for.
    void add(Vector w, double length) {
        if (length > 0)
            for (double& value : w) value /= length;
        if (preconditioner_ && length > 0)
            for (double& value : image_) value /= length;
        directions_.push_back(std::move(w));
        if (preconditioner_) images_.push_back(image_);
    }

  private:
    const VectorOperator& preconditioner_;
    std::vector<Vector> directions_;
    std::vector<Vector> images_;
    Vector image_;
};

/// Ritz values and whether both extreme ones are within tolerance, by the residual |beta s_k|: its
/// square over the gap to the neighbouring Ritz value bounds the error.
struct Ritz {
    ExtremeEigenvalues values;
    bool settled;
};

Ritz ritz(const Vector& alpha, const Vector& beta, double tolerance, SpectrumEnds ends) {
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
    const bool low = ends == SpectrumEnds::largest ||
                     (k > 2 && error(0, 1) <= 0.1 * tolerance * std::abs(value[0]));
    const bool settled = k > 2 && low && error(k - 1, k - 2) <= tolerance * value[k - 1];
    return {{value[k - 1], value[0]}, settled};
}

} // namespace

VectorOperator operator_of(const NormalSystem& system) {
    return [&system, image = PointSet(system.size(), 1)](const Vector& x, Vector& y) mutable {
        system.apply(PointSet(x, 1), image);
        y = image.values();
    };
}

ExtremeEigenvalues lanczos(const VectorOperator& matrix, Index size, double tolerance,
                           SpectrumEnds ends, const VectorOperator& preconditioner) {
    constexpr Index most_steps = 600;
    Basis basis(preconditioner);
    Vector w = start_vector(matrix, size);
    basis.add(w, basis.length(w));
    Vector alpha;
    Vector beta;
    Ritz now{{}, false};
    Index next_look = 5;
    for (Index k = 0; k < std::min(size, most_steps); ++k) {
        matrix(basis.last_image(), w);
        alpha.push_back(dot(basis.last_image(), w));
        basis.make_orthogonal(w);
        beta.push_back(basis.length(w));
        const bool exhausted = beta.back() <= 1e-13 * std::abs(alpha[0]) || k + 1 == size;
        if (exhausted) beta.back() = 0;
        if (exhausted || k + 1 >= next_look) {
            now = ritz(alpha, beta, tolerance, ends);
            next_look = k + 1 + std::max<Index>(5, k / 4); // a look costs O(k^3)
        }
        if (exhausted || now.settled) break;
        basis.add(w, beta.back());
    }
    now.values.products = static_cast<Index>(alpha.size()) + 1; // that of the start, too
    return now.values;
}

namespace {

constexpr double rough = 1e-3;

/// Roughly the eigenvalues of the inverse, the largest settled. Throws SolverError where there is
/// none.
ExtremeEigenvalues of_inverse(const BandedMatrix& m) {
    const BandedCholesky factor(m);
    const VectorOperator inverse = [&](const Vector& in, Vector& out) {
        out = in;
        factor.solve(out.data(), {});
    };
    return lanczos(inverse, m.size(), rough, SpectrumEnds::largest);
}

/// The eigenvalue beyond which `estimate` lies nothing, sharpened by Lanczos on the inverse of the
/// matrix shifted past that end of the spectrum, the shift drawn closer: clustered ends separate.
/// `sign` +1: the largest, -1: the smallest. Counts the solves.
double sharpened(const BandedMatrix& m, double estimate, int sign, Index& solves) {
    for (double margin : {4 * rough, 1e-5, 1e-7, 1e-9}) {
        BandedMatrix shifted = m;
        const double shift = estimate * (1 + sign * margin);
        for (Index i = 0; i < m.size(); ++i)
            for (int k = 0; k <= m.bandwidth(); ++k)
                shifted.at(i, k) = sign * ((k == 0 ? shift : 0.0) - m.at(i, k));
        const ExtremeEigenvalues inverse = of_inverse(shifted);
        estimate = shift - sign / inverse.largest;
        solves += inverse.products;
    }
    return estimate;
}

} // namespace

ExtremeEigenvalues extreme_eigenvalues(const BandedMatrix& m, double tolerance) {
    const VectorOperator forward = [&](const Vector& in, Vector& out) {
        m.apply(in.data(), out.data(), {});
    };
    constexpr double loose = 1e-5;
    if (tolerance > loose) return lanczos(forward, m.size(), tolerance);
    ExtremeEigenvalues e = lanczos(forward, m.size(), rough);
    e.largest = sharpened(m, e.largest, 1, e.products);
    try {
        const ExtremeEigenvalues inverse = of_inverse(m);
        e.smallest = sharpened(m, 1 / inverse.largest, -1, e.products);
        e.products += inverse.products;
    } catch (const SolverError&) { // singular: only the plain iteration, which starts in the range,
                                   // sees past the zeros
        const ExtremeEigenvalues seen = lanczos(forward, m.size(), tolerance);
        e.smallest = seen.smallest;
        e.products += seen.products;
    }
    return e;
}

ExtremeEigenvalues scaled_eigenvalues(const NormalSystem& system, const std::vector<double>& scale,
                                      double tolerance) {
    constexpr double of_largest = 1e-4; // of the tolerance: steps must not pass 2 / largest
    const VectorOperator plain = operator_of(system);
    const VectorOperator whole = [&](Vector in, Vector& out) {
        for (std::size_t i = 0; i < in.size(); ++i) in[i] *= scale[i];
        plain(in, out);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] *= scale[i];
    };
    if (system.size() > most_dissected(system.axes().size()) ||
        std::ranges::find(scale, 0.0) != scale.end())
        return lanczos(whole, system.size(), tolerance);
    try {
        const auto factor = factorize(system);
        const VectorOperator inverse = [&](const Vector& in, Vector& out) {
            PointSet b(system.size(), 1);
            for (std::size_t i = 0; i < in.size(); ++i) b.values()[i] = in[i] / scale[i];
            b = factor->solve(std::move(b));
            for (std::size_t i = 0; i < in.size(); ++i) out[i] = b.values()[i] / scale[i];
        };
        const ExtremeEigenvalues low =
            lanczos(inverse, system.size(), tolerance / 10, SpectrumEnds::largest);
        const ExtremeEigenvalues high =
            lanczos(whole, system.size(), of_largest * tolerance, SpectrumEnds::largest);
        return {high.largest, 1 / low.largest, high.products + low.products};
    } catch (const SolverError&) { // singular: only products see past the zeros
        return lanczos(whole, system.size(), tolerance);
    }
}

ExtremeEigenvalues extreme_eigenvalues(const NormalSystem& system, double tolerance) {
    const auto factors = system.factors();
    if (factors.empty())
        return scaled_eigenvalues(
            system, std::vector<double>(static_cast<std::size_t>(system.size()), 1.0), tolerance);
    ExtremeEigenvalues product{1, 1, 0};
    for (const BandedMatrix* gram : factors) {
        const ExtremeEigenvalues e =
            extreme_eigenvalues(*gram, tolerance / static_cast<double>(factors.size()));
        product.largest *= e.largest;
        product.smallest *= e.smallest;
        product.products += e.products;
    }
    return product;
}

} // namespace batten
