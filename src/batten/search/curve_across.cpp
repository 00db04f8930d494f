#include <batten/search/curve_across.hpp>

#include <batten/core/vectors.hpp>
#include <batten/solve/banded_cholesky.hpp>
#include <batten/system/normal_system.hpp>
#include <batten/system/roughness.hpp>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

namespace batten {

namespace {

/// How the distance of a sample counts: w (I - part u u^T) for a unit vector u, row by row.
class Metric {
  public:
    Metric(double weight, std::span<const double> u, double part) : dim_(u.size()) {
        assert(dim_ <= static_cast<std::size_t>(most_coordinates));
        for (std::size_t d = 0; d < dim_; ++d)
            for (std::size_t e = 0; e < dim_; ++e)
                value_[d * dim_ + e] = weight * ((d == e ? 1 : 0) - part * u[d] * u[e]);
    }

    std::span<const double> operator[](Index d) const {
        return {value_.data() + static_cast<std::size_t>(d) * dim_, dim_};
    }

  private:
    std::size_t dim_;
    std::array<double, most_coordinates * most_coordinates> value_;
};

/// Normal equations whose unknowns are all coordinates, control point by control point.
class CoordinateSystem {
  public:
    CoordinateSystem(const KnotVector& knots, Index dim)
        : knots_(knots),
          dim_(dim),
          matrix_(knots.free_count() * dim, static_cast<int>((knots.degree() + 1) * dim) - 1,
                  knots.closure()),
          right_(knots.free_count(), dim) {}

    /// Adds the square of `point` - C(t) in a metric.
    void add(double t, std::span<const double> point, double weight, const Metric& metric) {
        const ActiveFunctions b = active_functions(knots_, t, Numbering::free);
        weight_ += weight;
        for (int i = 0; i <= b.degree; ++i) {
            const double value = b.value[static_cast<std::size_t>(i)];
            const Index row = b.index(i);
            for (Index d = 0; d < dim_; ++d) {
                right_(row, d) += value * dot(metric[d], point);
                double* entry = &matrix_.at(row * dim_ + d, 0) - d; // of this row, coordinate 0
                for (Index e = d; e < dim_; ++e)
                    entry[e] += value * value * metric[d][static_cast<std::size_t>(e)];
                for (int j = i + 1; j <= b.degree; ++j) {
                    entry += dim_;
                    const double product = value * b.value[static_cast<std::size_t>(j)];
                    for (Index e = 0; e < dim_; ++e)
                        entry[e] += product * metric[d][static_cast<std::size_t>(e)];
                }
            }
        }
    }

    void add_roughness(double lambda, int order) {
        const BandedMatrix roughness = unit_roughness_matrix(knots_, order);
        for (Index i = 0; i < roughness.size(); ++i)
            for (int k = 0; k <= roughness.bandwidth(); ++k)
                for (Index d = 0; d < dim_; ++d)
                    matrix_.at(i * dim_ + d, static_cast<int>(k * dim_)) +=
                        lambda * weight_ * roughness.at(i, k);
    }

    PointSet solve(const Constraints& exact) const {
        const BandedCholesky factor(matrix_);
        PointSet control = right_;
        factor.solve(control.data(), {1, 1});
        if (!exact.empty()) hold(factor, exact, control);
        return control;
    }

  private:
    /// Moves the control points, as little as the equations weigh it, onto the constraints.
    void hold(const BandedCholesky& factor, const Constraints& exact, PointSet& control) const {
        const Index n = control.size();
        const Index count = exact.size();
        PointSet units(count, count);
        for (Index k = 0; k < count; ++k) units(k, k) = 1;
        const PointSet rows = exact.apply_transposed(units, n); // C^T, (n x count)
        PointSet columns(n * dim_, count * dim_);
        for (Index j = 0; j < n; ++j)
            for (Index k = 0; k < count; ++k)
                for (Index d = 0; d < dim_; ++d) columns(j * dim_ + d, k * dim_ + d) = rows(j, k);
        using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const Matrix across = Eigen::Map<Matrix>(columns.data(), n * dim_, count * dim_);
        factor.solve(columns.data(), {1, count * dim_});
        const Eigen::Map<const Matrix> moves(columns.data(), n * dim_, count * dim_);
        const Eigen::LDLT<Eigen::MatrixXd> schur(across.transpose() * moves);
        Eigen::Map<Eigen::VectorXd> x(control.data(), n * dim_);
        const Eigen::Map<const Eigen::VectorXd> wanted(exact.values().data(), count * dim_);
        constexpr int corrections = 3; // the later ones take out rounding
        for (int k = 0; k < corrections; ++k)
            x += moves * schur.solve(wanted - across.transpose() * x);
    }

    const KnotVector& knots_;
    Index dim_;
    BandedMatrix matrix_;
    PointSet right_;
    double weight_ = 0;
};

/// Part of a sample's distance along the curve that counts: by how much the curve bends on the way
/// to the sample, and at least so much that control points cannot slide along a straight piece.
double part_along(const CurvePoint& at, std::span<const double> gap, double speed_square) {
    constexpr double least = 0.01;
    double bend = 0; // of the second derivative, along the curve
    double distance_square = 0;
    for (std::size_t d = 0; d < gap.size(); ++d) {
        bend += at.first[d] * at.second[d];
        distance_square += gap[d] * gap[d];
    }
    double curvature_square = 0;
    for (std::size_t d = 0; d < gap.size(); ++d) {
        const double across = (at.second[d] - bend / speed_square * at.first[d]) / speed_square;
        curvature_square += across * across;
    }
    const double bent = std::sqrt(distance_square * curvature_square);
    return std::max(least, bent / (1 + bent));
}

} // namespace

bool parameter_stays(const CurveTask& task, Index sample) {
    const bool end = sample == 0 || sample + 1 == task.samples.size();
    return (end && task.closure == Closure::open) || std::ranges::binary_search(task.fixed, sample);
}

PointSet solve_across(const CurveTask& task, const CurveTrial& trial, const CurvePieces& last,
                      const Constraints& exact) {
    const Points& q = task.samples.points;
    const auto dim = static_cast<std::size_t>(q.dim());
    CoordinateSystem system(trial.knots, q.dim());
    std::vector<double> point(dim);
    std::vector<double> gap(dim);
    std::vector<double> u(dim);
    for (Index i = 0; i < q.size(); ++i) {
        const double t = trial.parameters[static_cast<std::size_t>(i)];
        const CurvePoint at = last(t);
        double square = 0;
        for (std::size_t d = 0; d < dim; ++d) {
            const double value = q(i, static_cast<Index>(d));
            point[d] = value - q(0, static_cast<Index>(d));
            gap[d] = value - at.point[d];
            square += at.first[d] * at.first[d];
        }
        const double weight = trial.weights[static_cast<std::size_t>(i)];
        double part = 0;
        if (square > 0 && !parameter_stays(task, i)) {
            for (std::size_t d = 0; d < dim; ++d) u[d] = at.first[d] / std::sqrt(square);
            part = 1 - part_along(at, gap, square);
        }
        system.add(t, point, weight, Metric(weight, u, part));
    }
    if (task.roughness > 0) system.add_roughness(task.roughness, 2);
    return uncentred(system.solve(exact.independent(trial.knots.free_count())),
                     {q[0].begin(), q[0].end()});
}

} // namespace batten
