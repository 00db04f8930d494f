#include "reference.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::reference {

Index span_of(const KnotVector& k, Long t) {
    Index span = k.degree();
    for (Index i = k.degree(); i < k.control_count(); ++i)
        if (k[i] < k[i + 1] && Long(k[i]) <= t) span = i;
    return span;
}

Long basis(const KnotVector& k, Index span, Index i, int p, Long t, int order) {
    if (i > span || i + p < span) return 0;
    if (p == 0) return order == 0 ? 1 : 0;
    const Long left = Long(k[i + p]) - Long(k[i]);
    const Long right = Long(k[i + p + 1]) - Long(k[i + 1]);
    const int lower = order > 0 ? order - 1 : 0;
    Long sum = 0;
    if (left > 0)
        sum += (order > 0 ? Long(p) : t - Long(k[i])) / left * basis(k, span, i, p - 1, t, lower);
    if (right > 0)
        sum += (order > 0 ? -Long(p) : Long(k[i + p + 1]) - t) / right *
               basis(k, span, i + 1, p - 1, t, lower);
    return sum;
}

Matrix stored_collocation(const KnotVector& k, const std::vector<double>& t, int order) {
    Matrix a = Matrix::Zero(static_cast<Index>(t.size()), k.control_count());
    for (Index j = 0; j < a.rows(); ++j) {
        const Long at = t[static_cast<std::size_t>(j)];
        const Index span = span_of(k, at);
        for (Index i = span - k.degree(); i <= span; ++i)
            a(j, i) = basis(k, span, i, k.degree(), at, order);
    }
    return a;
}

Matrix collocation(const KnotVector& k, const std::vector<double>& t, int order) {
    const Matrix stored = stored_collocation(k, t, order);
    Matrix a = stored.leftCols(k.free_count());
    for (Index i = k.free_count(); i < k.control_count(); ++i)
        a.col(i - k.free_count()) += stored.col(i);
    return a;
}

Matrix kronecker(const Matrix& a, const Matrix& b) {
    Matrix c(a.rows() * b.rows(), a.cols() * b.cols());
    for (Index r = 0; r < a.rows(); ++r)
        for (Index s = 0; s < a.cols(); ++s)
            c.block(r * b.rows(), s * b.cols(), b.rows(), b.cols()) = a(r, s) * b;
    return c;
}

Matrix scattered_collocation(const std::vector<KnotVector>& axes, const Points& parameters,
                             const std::vector<int>& orders) {
    Matrix all;
    for (Index j = 0; j < parameters.size(); ++j) {
        Matrix row = Matrix::Ones(1, 1);
        for (std::size_t k = 0; k < axes.size(); ++k)
            row = kronecker(row, collocation(axes[k], {parameters(j, static_cast<Index>(k))},
                                             orders.empty() ? 0 : orders[k]));
        if (j == 0) all.resize(parameters.size(), row.cols());
        all.row(j) = row;
    }
    return all;
}

Matrix matrix(const Points& points) {
    Matrix m(points.size(), points.dim());
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < points.dim(); ++d) m(i, d) = points(i, d);
    return m;
}

PointSet points(const Matrix& m) {
    PointSet result(m.rows(), m.cols());
    for (Index i = 0; i < m.rows(); ++i)
        for (Index d = 0; d < m.cols(); ++d) result(i, d) = static_cast<double>(m(i, d));
    return result;
}

Eigen::Matrix<Long, 1, Eigen::Dynamic>
point(const Spline& spline, const std::vector<double>& parameter, const std::vector<int>& orders) {
    Matrix row = Matrix::Ones(1, 1);
    for (std::size_t k = 0; k < parameter.size(); ++k)
        row = kronecker(row, stored_collocation(spline.axes()[k], {parameter[k]},
                                                orders.empty() ? 0 : orders[k]));
    return row * matrix(spline.control_points());
}

Matrix curve_points(const Spline& curve, const std::vector<double>& t, int order) {
    return stored_collocation(curve.axis(0), t, order) * matrix(curve.control_points());
}

std::vector<double> deviations(const Spline& spline, const Points& samples,
                               const Parameters& parameters) {
    std::vector<double> result;
    for (Index i = 0; i < samples.size(); ++i) {
        std::vector<double> at(static_cast<std::size_t>(spline.axis_count()));
        Index rest = i;
        for (std::size_t k = at.size(); k-- > 0;) {
            if (parameters.axes.empty()) {
                at[k] = parameters.scattered(i, static_cast<Index>(k));
                continue;
            }
            const auto count = static_cast<Index>(parameters.axes[k].size());
            at[k] = parameters.axes[k][static_cast<std::size_t>(rest % count)];
            rest /= count;
        }
        result.push_back(
            static_cast<double>((point(spline, at) - matrix(samples.slice(i, 1))).norm()));
    }
    return result;
}

double largest(const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

Matrix least_squares(const Matrix& a, const Matrix& q) {
    return a.householderQr().solve(q);
}

Matrix least_squares(const Matrix& a, const Matrix& q, const Matrix& c, const Matrix& d) {
    const Index n = a.cols();
    Matrix saddle = Matrix::Zero(n + c.rows(), n + c.rows());
    Matrix right = Matrix::Zero(n + c.rows(), q.cols());
    std::vector<Index> active;
    for (Index j = 0; j < a.rows(); ++j) { // a row of A has few entries
        active.clear();
        for (Index i = 0; i < n; ++i)
            if (a(j, i) != 0) active.push_back(i);
        for (Index r : active) {
            for (Index s : active) saddle(r, s) += a(j, r) * a(j, s);
            right.row(r) += a(j, r) * q.row(j);
        }
    }
    saddle.bottomLeftCorner(c.rows(), n) = c;
    saddle.topRightCorner(n, c.rows()) = c.transpose();
    right.bottomRows(c.rows()) = d;
    return saddle.fullPivLu().solve(right).topRows(n);
}

double difference(const Matrix& expected, const Points& found) {
    if (expected.rows() != found.size() || expected.cols() != found.dim())
        return std::numeric_limits<double>::infinity();
    return static_cast<double>((expected - matrix(found)).cwiseAbs().maxCoeff());
}

Matrix product(const Matrix& a, const Matrix& b) {
    return a * b;
}

Matrix transposed_product(const Matrix& a, const Matrix& b) {
    return a.transpose() * b;
}

Matrix solve(const Matrix& a, const Matrix& b) {
    return a.fullPivLu().solve(b);
}

Matrix solve_definite(const Matrix& a, const Matrix& b) {
    return a.ldlt().solve(b);
}

std::vector<double> singular_values(const Matrix& a) {
    const Eigen::VectorXd sigma =
        Eigen::JacobiSVD<Eigen::MatrixXd>(a.cast<double>()).singularValues();
    return {sigma.begin(), sigma.end()};
}

Index rank(const Matrix& a, double threshold) {
    Eigen::FullPivLU<Matrix> lu(a);
    lu.setThreshold(threshold);
    return lu.rank();
}

double spectral_radius(const Matrix& a) {
    return Eigen::MatrixXd(a.cast<double>()).eigenvalues().cwiseAbs().maxCoeff();
}

} // namespace batten::reference
