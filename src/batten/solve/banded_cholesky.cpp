#include <batten/solve/banded_cholesky.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr double smallest_pivot = 1e-14; // of the diagonal entry: below it rounding made the pivot

double inverse_root(double pivot, double entry, Index row) {
    if (!(pivot > smallest_pivot * entry) || !(entry > 0))
        throw SolverError(fmt::format(
            "the normal equations are singular: control point {} is not determined by the samples",
            row));
    return 1 / std::sqrt(pivot);
}

} // namespace

BandedCholesky::BandedCholesky(const BandedMatrix& matrix)
    : size_(matrix.size()),
      border_(matrix.closure() == Closure::closed
                  ? std::min<Index>(matrix.bandwidth(), matrix.size())
                  : 0),
      bandwidth_(matrix.bandwidth()) {
    factor_band(matrix);
    if (border_ > 0) factor_border(matrix);
}

void BandedCholesky::factor_band(const BandedMatrix& matrix) {
    const Index width = bandwidth_ + 1;
    const Index rows = size_ - border_;
    band_.assign(static_cast<std::size_t>(rows * width), 0.0);
    for (Index i = 0; i < rows; ++i) {
        double* row = band_.data() + i * width;
        const Index reach = std::min<Index>(i, bandwidth_);
        for (Index k = reach; k >= 1; --k) {
            const Index j = i - k;
            const double* other = band_.data() + j * width;
            double sum = matrix.at(j, static_cast<int>(k));
            for (Index s = k + 1; s <= reach; ++s) sum -= row[s] * other[s - k];
            row[k] = sum * other[0];
        }
        double pivot = matrix.at(i, 0);
        for (Index k = 1; k <= reach; ++k) pivot -= row[k] * row[k];
        row[0] = inverse_root(pivot, matrix.at(i, 0), i);
    }
}

void BandedCholesky::factor_border(const BandedMatrix& matrix) {
    const Index rows = size_ - border_;
    const Index width = bandwidth_ + 1;
    corner_.assign(static_cast<std::size_t>(border_ * size_), 0.0);
    const auto corner = [&](Index b) { return corner_.data() + b * size_; };
    for (Index i = 0; i < size_; ++i)
        for (int k = 0; k <= bandwidth_; ++k) {
            const Index j = (i + k) % size_;
            const Index high = std::max(i, j);
            if (high >= rows) corner(high - rows)[std::min(i, j)] += matrix.at(i, k);
        }
    for (Index b = 0; b < border_; ++b) {
        double* row = corner(b);
        for (Index j = 0; j < rows; ++j) {
            const double* other = band_.data() + j * width;
            double sum = row[j];
            for (Index k = 1; k <= std::min<Index>(j, bandwidth_); ++k)
                sum -= other[k] * row[j - k];
            row[j] = sum * other[0];
        }
        for (Index c = 0; c <= b; ++c) {
            const double* other = corner(c);
            const double entry = row[rows + c];
            double sum = entry;
            for (Index k = 0; k < rows + c; ++k) sum -= row[k] * other[k];
            row[rows + c] = c < b ? sum * other[rows + c] : inverse_root(sum, entry, rows + b);
        }
    }
}

void BandedCholesky::solve_one(double* x, Index inner) const {
    const Index rows = size_ - border_;
    const Index width = bandwidth_ + 1;
    const auto subtract = [&](Index to, double factor, Index from) {
        for (Index k = 0; k < inner; ++k) x[to * inner + k] -= factor * x[from * inner + k];
    };
    const auto scale = [&](Index at, double factor) {
        for (Index k = 0; k < inner; ++k) x[at * inner + k] *= factor;
    };
    for (Index i = 0; i < rows; ++i) {
        const double* row = band_.data() + i * width;
        for (Index k = std::min<Index>(i, bandwidth_); k >= 1; --k) subtract(i, row[k], i - k);
        scale(i, row[0]);
    }
    for (Index b = 0; b < border_; ++b) {
        const double* row = corner_.data() + b * size_;
        for (Index j = 0; j < rows + b; ++j)
            if (row[j] != 0) subtract(rows + b, row[j], j);
        scale(rows + b, row[rows + b]);
    }
    for (Index b = border_; b-- > 0;) {
        const double* row = corner_.data() + b * size_;
        scale(rows + b, row[rows + b]);
        for (Index j = 0; j < rows + b; ++j)
            if (row[j] != 0) subtract(j, row[j], rows + b);
    }
    for (Index i = rows; i-- > 0;) {
        const double* row = band_.data() + i * width;
        scale(i, row[0]);
        for (Index k = 1; k <= std::min<Index>(i, bandwidth_); ++k) subtract(i - k, row[k], i);
    }
}

void BandedCholesky::solve(double* x, AxisLayout layout) const {
    for_each_chunk(layout.outer,
                   [&](Index o) { solve_one(x + o * size_ * layout.inner, layout.inner); });
}

} // namespace batten
