#include <batten/core/points.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace batten {

Points::Points(const double* data, Index count, Index dim)
    : data_(std::shared_ptr<const double>(), data), count_(count), dim_(dim) {}

Points::Points(std::shared_ptr<const double> data, Index count, Index dim)
    : data_(std::move(data)), count_(count), dim_(dim) {}

Points::Points(const PointSet& set) : Points(set.data(), set.size(), set.dim()) {}

Points::Points(PointSet&& set) : count_(set.size()), dim_(set.dim()) {
    auto storage = std::make_shared<std::vector<double>>(std::move(set.values()));
    data_ = std::shared_ptr<const double>(storage, storage->data());
}

Points Points::slice(Index first, Index count) const {
    assert(first >= 0 && count >= 0 && first + count <= count_);
    return {std::shared_ptr<const double>(data_, data_.get() + first * dim_), count, dim_};
}

PointSet::PointSet(std::vector<double> values, Index dim)
    : values_(std::move(values)),
      count_(dim > 0 ? static_cast<Index>(values_.size()) / dim : 0),
      dim_(dim) {
    assert(count_ * dim_ == static_cast<Index>(values_.size()));
}

PointSet::PointSet(const Points& points)
    : values_(points.data(), points.data() + points.size() * points.dim()),
      count_(points.size()),
      dim_(points.dim()) {}

void add_scaled(PointSet& y, double factor, const PointSet& x) {
    assert(y.values().size() == x.values().size());
    double* out = y.data();
    const double* in = x.data();
    const std::size_t count = y.values().size();
    for (std::size_t k = 0; k < count; ++k) out[k] += factor * in[k];
}

double inner_product(const PointSet& a, const PointSet& b) {
    assert(a.values().size() == b.values().size());
    double sum = 0;
    for (std::size_t k = 0; k < a.values().size(); ++k) sum += a.values()[k] * b.values()[k];
    return sum;
}

double frobenius_norm(const PointSet& a) {
    return std::sqrt(inner_product(a, a));
}

double largest_length(const PointSet& a) {
    double largest = 0;
    for (Index i = 0; i < a.size(); ++i) {
        double square = 0;
        for (double x : a[i]) square += x * x;
        largest = std::max(largest, square);
    }
    return std::sqrt(largest);
}

} // namespace batten
