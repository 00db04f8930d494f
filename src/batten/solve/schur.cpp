#include <batten/solve/schur.hpp>

#include <batten/core/vectors.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

namespace batten {

namespace {

using Dense = Eigen::MatrixXd;

/// Unit vectors first to last - 1 of so many.
PointSet units(Index size, Index first, Index last) {
    PointSet result(size, last - first);
    for (Index i = first; i < last; ++i) result(i, i - first) = 1;
    return result;
}

} // namespace

struct SchurComplement::Matrix {
    Dense values;
    Eigen::LLT<Dense> fast;
    Eigen::LDLT<Dense> careful; // where the other one would lose digits

    void factor() {
        constexpr double enough = 1e-8; // of the condition's inverse
        values = (values + values.transpose()).eval() / 2;
        fast.compute(values);
        if (fast.info() != Eigen::Success || !(fast.rcond() > enough)) careful.compute(values);
    }
    Dense solve(const Dense& b) const {
        return careful.rows() > 0 ? Dense(careful.solve(b)) : Dense(fast.solve(b));
    }
};

SchurComplement::SchurComplement(const Factorization& normal, const Constraints& constraints,
                                 Index controls)
    : normal_(normal),
      constraints_(constraints),
      controls_(controls),
      band_(normal.bordered(constraints)) {
    if (band_) return;
    constexpr Index together = 64; // solves, so that their memory does not grow with k
    const Index k = constraints.size();
    matrix_ = std::make_unique<Matrix>();
    matrix_->values.resize(k, k);
    for (Index first = 0; first < k; first += together) {
        const Index last = std::min(first + together, k);
        const PointSet s = apply(units(k, first, last));
        for (Index i = 0; i < k; ++i)
            for (Index j = first; j < last; ++j) matrix_->values(i, j) = s(i, j - first);
    }
    matrix_->factor();
}

SchurComplement::~SchurComplement() = default;

PointSet SchurComplement::apply(const PointSet& x) const {
    return constraints_.apply(normal_.solve(constraints_.apply_transposed(x, controls_)));
}

PointSet SchurComplement::solve(const PointSet& b) const {
    PointSet x = b;
    if (band_) {
        x = band_->multipliers(b);
        scale(x.values(), -1);
        return x;
    }
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> rows(x.data(), x.size(), x.dim());
    rows = matrix_->solve(Dense(rows));
    return x;
}

double SchurComplement::largest_eigenvalue() const {
    constexpr Index few = 512;
    const Index k = constraints_.size();
    if (band_ && k > few) {
        const VectorOperator times = [&](const std::vector<double>& in, std::vector<double>& out) {
            out = apply(PointSet(in, 1)).values();
        };
        return lanczos(times, k, 1e-3, SpectrumEnds::largest).largest;
    }
    Dense values;
    if (band_) {
        const PointSet s = apply(units(k, 0, k));
        values = Eigen::Map<const Dense>(s.data(), k, k);
        values = (values + values.transpose()).eval() / 2;
    }
    return Eigen::SelfAdjointEigenSolver<Dense>(band_ ? values : matrix_->values,
                                                Eigen::EigenvaluesOnly)
        .eigenvalues()
        .maxCoeff();
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
