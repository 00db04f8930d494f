#pragma once

#include <batten/core/index.hpp>

#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace batten {

class PointSet;

/// Read-only view of m points in dim-space, row-major (m x dim) doubles; cheap to copy.
///
/// A view either borrows memory, which must outlive it, or shares its ownership (a PointSet moved
/// in, a foreign array with its own deleter).
class Points {
  public:
    Points() = default;
    /// Borrows `count * dim` doubles at `data`.
    Points(const double* data, Index count, Index dim);
    /// Shares ownership of `count * dim` doubles at `data`.
    Points(std::shared_ptr<const double> data, Index count, Index dim);
    /// Borrows from `set`.
    Points(const PointSet&
               set); // NOLINT(google-explicit-constructor): a set is used wherever a view is
    /// Takes over the storage of `set`.
    Points(PointSet&& set); // NOLINT(google-explicit-constructor)

    Index size() const { return count_; }
    Index dim() const { return dim_; }
    bool empty() const { return count_ == 0; }
    const double* data() const { return data_.get(); }
    std::span<const double> operator[](Index i) const {
        return {data_.get() + i * dim_, static_cast<std::size_t>(dim_)};
    }
    double operator()(Index i, Index d) const { return data_.get()[i * dim_ + d]; }
    /// View of points `first` to `first + count - 1`.
    Points slice(Index first, Index count) const;

  private:
    std::shared_ptr<const double> data_;
    Index count_ = 0;
    Index dim_ = 0;
};

/// Owned points, (m x dim) row-major doubles, zero at construction.
class PointSet {
  public:
    PointSet() = default;
    PointSet(Index count, Index dim)
        : values_(static_cast<std::size_t>(count * dim)), count_(count), dim_(dim) {}
    PointSet(std::vector<double> values, Index dim);
    explicit PointSet(const Points& points);

    Index size() const { return count_; }
    Index dim() const { return dim_; }
    bool empty() const { return count_ == 0; }
    double* data() { return values_.data(); }
    const double* data() const { return values_.data(); }
    std::vector<double>& values() { return values_; }
    const std::vector<double>& values() const { return values_; }
    std::span<double> operator[](Index i) {
        return {values_.data() + i * dim_, static_cast<std::size_t>(dim_)};
    }
    std::span<const double> operator[](Index i) const {
        return {values_.data() + i * dim_, static_cast<std::size_t>(dim_)};
    }
    double& operator()(Index i, Index d) { return values_[static_cast<std::size_t>(i * dim_ + d)]; }
    double operator()(Index i, Index d) const {
        return values_[static_cast<std::size_t>(i * dim_ + d)];
    }
    void fill(double value) { values_.assign(values_.size(), value); }

  private:
    std::vector<double> values_;
    Index count_ = 0;
    Index dim_ = 0;
};

/// `y += factor * x`, over all coordinates of sets of one shape.
void add_scaled(PointSet& y, double factor, const PointSet& x);

/// Sum over all coordinates of `a * b` (the Frobenius inner product).
double inner_product(const PointSet& a, const PointSet& b);

/// Frobenius norm: square root of the sum of all squared coordinates.
double frobenius_norm(const PointSet& a);

/// Largest Euclidean length of a row.
double largest_length(const PointSet& a);

/// Euclidean distance of two points of one dimension.
inline double distance(std::span<const double> a, std::span<const double> b) {
    double square = 0;
    for (std::size_t d = 0; d < a.size(); ++d) square += (a[d] - b[d]) * (a[d] - b[d]);
    return std::sqrt(square);
}

} // namespace batten
