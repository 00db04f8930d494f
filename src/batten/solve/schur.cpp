#include <batten/solve/schur.hpp>

#include <Eigen/Dense>

namespace batten {

struct SchurComplement::Matrix {
    Eigen::MatrixXd values;
    Eigen::LDLT<Eigen::MatrixXd> factor;
};

SchurComplement::SchurComplement(const Factorization& normal, const Constraints& constraints,
                                 Index controls)
    : matrix_(std::make_unique<Matrix>()) {
    const Index k = constraints.size();
    PointSet unit(k, k);
    for (Index i = 0; i < k; ++i) unit(i, i) = 1;
    const PointSet s =
        constraints.apply(normal.solve(constraints.apply_transposed(unit, controls)));
    matrix_->values = Eigen::Map<const Eigen::MatrixXd>(s.data(), k, k);
    matrix_->values = (matrix_->values + matrix_->values.transpose()).eval() / 2;
    matrix_->factor.compute(matrix_->values);
}

SchurComplement::~SchurComplement() = default;

PointSet SchurComplement::solve(const PointSet& b) const {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    PointSet x = b;
    Eigen::Map<Rows> rows(x.data(), x.size(), x.dim());
    rows = matrix_->factor.solve(Eigen::MatrixXd(rows));
    return x;
}

ExtremeEigenvalues SchurComplement::eigenvalues() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix_->values,
                                                                Eigen::EigenvaluesOnly);
    return {solver.eigenvalues().maxCoeff(), solver.eigenvalues().minCoeff()};
}

} // namespace batten
