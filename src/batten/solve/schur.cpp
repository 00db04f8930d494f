#include <batten/solve/schur.hpp>

#include <Eigen/Dense>
#include <limits>

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

PointSet onto_constraints(PointSet control, const Constraints& constraints,
                          const Factorization& normal, const SchurComplement& schur) {
    constexpr int most_passes = 5; // each takes up what rounding left of the one before
    double last = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < most_passes; ++pass) {
        PointSet gap = constraints.apply(control);
        add_scaled(gap, -1.0, constraints.values());
        const double missing = largest_length(gap);
        if (pass > 1 && !(missing < last / 2)) break;
        last = missing;
        const PointSet multipliers = schur.solve(gap);
        add_scaled(control, -1.0,
                   normal.solve(constraints.apply_transposed(multipliers, control.size())));
    }
    return control;
}

} // namespace batten
