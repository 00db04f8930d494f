#include <batten/system/banded_matrix.hpp>

#include <batten/core/vectors.hpp>

#include <algorithm>

namespace batten {

BandedMatrix::BandedMatrix(Index size, int bandwidth, Closure closure)
    : size_(size),
      bandwidth_(bandwidth),
      closure_(closure),
      values_(static_cast<std::size_t>(size * (bandwidth + 1))) {}

void BandedMatrix::apply(const double* x, double* y, AxisLayout layout) const {
    const Index inner = layout.inner;
    std::fill(y, y + layout.outer * size_ * inner, 0.0);
    for_each_chunk(layout.outer, [&](Index o) {
        const double* in = x + o * size_ * inner;
        double* out = y + o * size_ * inner;
        for (Index i = 0; i < size_; ++i) {
            add_scaled(out + i * inner, at(i, 0), in + i * inner, inner);
            for (int k = 1; k <= bandwidth_; ++k) {
                Index j = i + k;
                if (j >= size_) {
                    if (closure_ == Closure::open) break;
                    j -= size_;
                }
                add_scaled(out + i * inner, at(i, k), in + j * inner, inner);
                add_scaled(out + j * inner, at(i, k), in + i * inner, inner);
            }
        }
    });
}

std::vector<double> BandedMatrix::diagonal() const {
    std::vector<double> result;
    for (Index i = 0; i < size_; ++i) result.push_back(at(i, 0));
    return result;
}

void BandedMatrix::add(double factor, const BandedMatrix& other) {
    for (std::size_t k = 0; k < values_.size(); ++k) values_[k] += factor * other.values_[k];
}

void BandedMatrix::divide(double divisor) {
    for (double& value : values_) value /= divisor;
}

double BandedMatrix::total() const {
    double sum = 0;
    for (Index i = 0; i < size_; ++i)
        for (int k = 0; k <= bandwidth_; ++k) sum += (k == 0 ? 1 : 2) * at(i, k);
    return sum;
}

} // namespace batten
