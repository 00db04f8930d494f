#pragma once

#include <batten/basis/active_functions.hpp>
#include <batten/core/core.hpp>

#include <span>
#include <vector>

namespace batten {

/// A block of values seen as (outer x n x inner), row-major: an array of several axes with one
/// singled out.
struct AxisLayout {
    Index outer = 1;
    Index inner = 1;
};

/// One axis of the points (size x dim) of a grid singled out.
inline AxisLayout along(const GridIndex& grid, std::size_t axis, Index dim) {
    return {grid.blocks(axis), grid.stride(axis) * dim};
}

/// Symmetric banded matrix (n x n): entries (i, i + k) for k = 0 to the bandwidth; i + k goes
/// around the end when the axis is closed.
class BandedMatrix {
  public:
    BandedMatrix() = default;
    BandedMatrix(Index size, int bandwidth, Closure closure);

    Index size() const { return size_; }
    int bandwidth() const { return bandwidth_; }
    Closure closure() const { return closure_; }
    /// Entry (i, i + k), 0 <= k <= bandwidth. On a closed axis several (i, k) may mean one entry:
    /// they add up.
    double& at(Index i, int k) {
        return values_[static_cast<std::size_t>(i * (bandwidth_ + 1) + k)];
    }
    double at(Index i, int k) const {
        return values_[static_cast<std::size_t>(i * (bandwidth_ + 1) + k)];
    }

    /// Adds weight b b^T for the values b of active functions, counted as free.
    void add_outer(double weight, const ActiveFunctions& b) {
        for (int i = 0; i <= b.degree; ++i)
            for (int j = i; j <= b.degree; ++j)
                at(b.index(i), j - i) += weight * b.value[static_cast<std::size_t>(i)] *
                                         b.value[static_cast<std::size_t>(j)];
    }

    /// Calls `visit(row, column, value)` for the entries of the band, those above the diagonal and
    /// those below; on a short closed axis several may mean one place.
    template <class Visit>
    void for_each_entry(Visit visit) const {
        for (Index i = 0; i < size_; ++i)
            for (int k = 0; k <= bandwidth_; ++k) {
                const Index j = i + k < size_ ? i + k : i + k - size_;
                if (j < i && closure_ == Closure::open) break;
                visit(i, j, at(i, k));
                if (k > 0) visit(j, i, at(i, k));
            }
    }

    /// y = M x along one axis, x and y (outer x n x inner).
    void apply(const double* x, double* y, AxisLayout layout) const;
    std::vector<double> diagonal() const;
    /// Adds factor times a matrix of the same shape.
    void add(double factor, const BandedMatrix& other);
    /// Divides all entries by a number.
    void divide(double divisor);
    /// Sum of all entries.
    double total() const;
    /// The entries as they are stored: (n x (bandwidth + 1)).
    std::span<const double> values() const { return values_; }
    std::span<double> values() { return values_; }

    bool operator==(const BandedMatrix&) const = default;

  private:
    Index size_ = 0;
    int bandwidth_ = 0;
    Closure closure_ = Closure::open;
    std::vector<double> values_;
};

} // namespace batten
