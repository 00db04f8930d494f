#include <batten/iterate/preconditioner.hpp>

#include <batten/iterate/lin2018.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The middle of the band, what is left out added to the diagonal; rows of nothing become the
/// identity's.
BandedMatrix compensated(const BandedMatrix& matrix, int diagonals) {
    constexpr double rounding = 1e-12;
    const Index n = matrix.size();
    const int kept = std::min(diagonals, matrix.bandwidth());
    BandedMatrix result(n, kept, matrix.closure());
    std::vector<double> sums(static_cast<std::size_t>(n), 0);
    for (Index i = 0; i < n; ++i)
        for (int k = 0; k <= matrix.bandwidth(); ++k) {
            const Index j = i + k < n ? i + k : i + k - n;
            if (j < i && matrix.closure() == Closure::open) break;
            const double size = std::abs(matrix.at(i, k));
            sums[static_cast<std::size_t>(i)] += size;
            if (k > 0) sums[static_cast<std::size_t>(j)] += size;
            if (k <= kept) {
                result.at(i, k) += matrix.at(i, k);
            } else {
                result.at(i, 0) += size;
                result.at(j, 0) += size;
            }
        }
    const double least = rounding * std::ranges::max(sums);
    for (Index i = 0; i < n; ++i)
        if (sums[static_cast<std::size_t>(i)] <= least) result.at(i, 0) = 1;
    return result;
}

} // namespace

Preconditioning::Preconditioning(const NormalSystem& system, Preconditioner kind) {
    if (kind == Preconditioner::none) return;
    inverse_diagonal_ = system.diagonal();
    for (double& x : inverse_diagonal_) x = x > 0 ? 1 / x : 0;
    if (kind == Preconditioner::axes) axes_ = factorize_axes(system);
}

Preconditioning Preconditioning::compensated_bands(const NormalSystem& system, int diagonals) {
    Preconditioning result;
    result.inverse_diagonal_ = diagonal_steps(system);
    for (result.diagonals_ = diagonals;; --result.diagonals_) {
        std::vector<BandedMatrix> bands;
        for (const BandedMatrix* factor : system.factors())
            bands.push_back(compensated(*factor, result.diagonals_));
        result.axes_ = factorize(bands, system.controls());
        if (result.axes_ || result.diagonals_ == 0) return result;
    }
}

Preconditioning Preconditioning::row_sums(const NormalSystem& system) {
    Preconditioning result;
    result.inverse_diagonal_ = diagonal_steps(system);
    return result;
}

void Preconditioning::apply(PointSet& x) const {
    if (axes_) {
        x = axes_->solve(std::move(x));
        for (Index i = 0; i < x.size(); ++i) // control points without samples stay
            if (inverse_diagonal_[static_cast<std::size_t>(i)] == 0) std::ranges::fill(x[i], 0.0);
    } else if (!inverse_diagonal_.empty()) {
        scale_rows(x, inverse_diagonal_);
    }
}

} // namespace batten
