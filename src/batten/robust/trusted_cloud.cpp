#include <batten/robust/trusted_cloud.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace batten {

namespace {

constexpr Index per_term = 3; ///< neighbours that make a polynomial

constexpr int terms_of(int axes, int degree) {
    return degree == 1 ? 1 + axes : 1 + axes + axes * (axes + 1) / 2;
}

constexpr int most_terms = terms_of(3, 2);
// one size for all polynomials: six fixed ones take the compiler a minute and save nothing
using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_terms, most_terms>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_terms, 1>;

constexpr double rounding = 1e-10; ///< of the number of neighbours

/// The same as `solve` where some eigenvalues are 0 to working accuracy.
bool solve_by_modes(const Normal& normal, Vector& at_sample) {
    const Eigen::SelfAdjointEigenSolver<Normal> modes(normal);
    Vector by_mode = modes.eigenvectors().transpose() * at_sample;
    double determined = 0;
    for (Eigen::Index k = 0; k < by_mode.size(); ++k) {
        if (modes.eigenvalues()(k) > rounding * normal(0, 0)) {
            determined += by_mode(k) * by_mode(k);
            by_mode(k) /= modes.eigenvalues()(k);
        } else {
            by_mode(k) = 0;
        }
    }
    at_sample.noalias() = modes.eigenvectors() * by_mode;
    return determined > 1 - rounding;
}

/// Shortest solution of the normal equations of a polynomial whose value at the sample is wanted;
/// nothing where they do not determine that.
bool solve(const Normal& normal, Vector& at_sample) {
    const Eigen::LDLT<Normal> factors(normal);
    at_sample = Vector::Unit(normal.rows(), 0);
    if (factors.vectorD().minCoeff() <= rounding * normal(0, 0))
        return solve_by_modes(normal, at_sample);
    factors.solveInPlace(at_sample);
    return true;
}

/// What least squares by a polynomial miss of a sample.
template <int axes, int degree>
Prediction polynomial(const PointSet& points, const PointSet& places, const Metric& metric,
                      Index sample, const PlaceTree::Neighbours& neighbours,
                      std::span<double> way) {
    constexpr int terms = terms_of(axes, degree);
    using Terms = std::array<double, terms>;
    const double radius = std::sqrt(neighbours.back().square);
    const double scale = radius > 0 ? 1 / radius : 1;
    const auto terms_at = [&](Index i) {
        Terms value{1};
        std::size_t t = 1;
        for (int d = 0; d < axes; ++d)
            value[t++] =
                scale * metric[static_cast<std::size_t>(d)] * (places(i, d) - places(sample, d));
        if constexpr (degree > 1)
            for (std::size_t d = 1; d <= axes; ++d)
                for (std::size_t e = d; e <= axes; ++e) value[t++] = value[d] * value[e];
        return value;
    };
    Normal normal = Normal::Zero(terms, terms);
    for (const auto& [square, i] : neighbours) {
        const Terms value = terms_at(i);
        for (std::size_t s = 0; s < terms; ++s)
            for (std::size_t t = 0; t < terms; ++t)
                normal(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(s)) +=
                    value[s] * value[t];
    }
    Vector at_sample;
    if (!solve(normal, at_sample)) return {};
    const auto value_of = [&](const Terms& value) {
        return std::inner_product(value.begin(), value.end(), at_sample.data(), 0.0);
    };
    double sum_of_squares = 0;
    for (Index k = 0; k < points.dim(); ++k) {
        double off = 0;
        for (const auto& [square, i] : neighbours)
            off += value_of(terms_at(i)) * (points(i, k) - points(sample, k));
        if (!way.empty()) way[static_cast<std::size_t>(k)] = off;
        sum_of_squares += off * off;
    }
    return {std::sqrt(sum_of_squares), std::sqrt(1 + at_sample(0))};
}

} // namespace

TrustedCloud::TrustedCloud(const Points& points, const Points& places)
    : tree_(places),
      points_(points.size(), points.dim()),
      trusted_(static_cast<std::size_t>(points.size()), 1) {
    for (Index i = 0; i < size(); ++i) std::ranges::copy(points[original(i)], points_[i].begin());
}

void TrustedCloud::nearest(Index sample, Index count, Neighbours& found) const {
    tree_.nearest(sample, count, metric_, trusted_, found);
}

template <int axes>
Prediction TrustedCloud::by_polynomial(Index sample, Neighbours& found,
                                       std::span<double> off) const {
    constexpr Index enough = per_term * terms_of(axes, 2);
    for (Index count = enough; count <= 4 * enough; count *= 2) {
        nearest(sample, count, found);
        if (std::ssize(found) < enough) break;
        const Prediction result =
            polynomial<axes, 2>(points_, tree_.places(), metric_, sample, found, off);
        if (result.exists()) return result;
    }
    if (std::ssize(found) < per_term * terms_of(axes, 1)) return {};
    return polynomial<axes, 1>(points_, tree_.places(), metric_, sample, found, off);
}

Prediction TrustedCloud::predict(Index sample, Neighbours& found, std::span<double> off) const {
    if (axes() == 1) return by_polynomial<1>(sample, found, off);
    if (axes() == 2) return by_polynomial<2>(sample, found, off);
    return by_polynomial<3>(sample, found, off);
}

LocalProcess TrustedCloud::process(Index sample, const Neighbours& neighbours) const {
    const std::ptrdiff_t k = std::ssize(neighbours);
    const PointSet& all = tree_.places();
    Eigen::MatrixXd places(k, axes());
    Eigen::MatrixXd values(k, points_.dim());
    for (Index j = 0; j < k; ++j) {
        const Index i = neighbours[static_cast<std::size_t>(j)].place;
        for (Index d = 0; d < axes(); ++d)
            places(j, d) = metric_[static_cast<std::size_t>(d)] * (all(i, d) - all(sample, d));
        for (Index d = 0; d < points_.dim(); ++d) values(j, d) = points_(i, d) - points_(sample, d);
    }
    return {places, values};
}

} // namespace batten
