#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/solve/rotation.hpp>
#include <batten/system/banded_matrix.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace batten {

/// A row of a least-squares problem along one axis: entries from column `lead` on, and those of a
/// closed axis's last columns.
struct BandedRow {
    Index lead = 0;
    std::array<Extended, max_degree + 1> band{};
    std::array<Extended, max_degree> border{};
};

/// Upper triangular R of the rows of a banded least-squares problem, rotated in one by one with
/// their right-hand sides [GolubVanLoan2013, section 5.2.5]: R^T R is the normal equations' matrix,
/// at the root of its condition. A closed axis's last degree columns are a border.
class BandedQr {
  public:
    /// Of `size` columns, rows of degree + 1 entries, and right-hand sides of so many columns.
    BandedQr(Index size, int degree, Closure closure, Index rhs_columns = 0);

    Index size() const { return size_; }
    Closure closure() const { return border_ > 0 ? Closure::closed : Closure::open; }
    /// Columns before the border.
    Index inner_size() const { return size_ - border_; }
    /// Leading column of a row of active functions, the first of which is given.
    Index lead(Index first) const {
        const bool around = first + degree_ >= size_;
        return std::min(around ? 0 : first, inner_size());
    }
    /// The values of active functions as a row, times a factor.
    BandedRow row(const ActiveFunctions& active, Extended factor) const;
    /// Row i of R.
    BandedRow row(Index i) const;
    /// Rotates a row in; `rhs` is its right-hand side, and then what is left of it. Rows come in
    /// the order of their leading columns, those of the border alone last.
    void add(BandedRow row, Extended* rhs);
    /// Rotates in the rows of others, each made of rows that led no later than the next one's.
    void merge(const std::vector<BandedQr>& others);
    /// Sum of the squares of what no solution can take away.
    Extended left_over() const { return left_over_; }
    Index rhs_columns() const { return columns_; }
    /// Row i of Q^T b.
    std::span<const Extended> rotated(Index i) const {
        return {rhs_.data() + i * columns_, static_cast<std::size_t>(columns_)};
    }
    /// Q^T b, (size x columns).
    const std::vector<Extended>& rotated() const { return rhs_; }
    /// Throws SolverError naming a column that the others all but span.
    void check() const;

    /// In place along one axis, (outer x n x inner): x = R x, R^T x, R^{-1} x and R^{-T} x.
    void apply(Extended* x, AxisLayout layout) const;
    void apply_transposed(Extended* x, AxisLayout layout) const;
    void solve(Extended* x, AxisLayout layout) const;
    void solve_transposed(Extended* x, AxisLayout layout) const;

    /// Calls `visit(row, column, value)` for numbers that add up to R^T R.
    void for_each_product(FunctionRef<void(Index row, Index column, Extended value)> visit) const;
    /// The squared Frobenius norm of R_rows R^{-1}: of rows that are part of R's, the trace of the
    /// matrix that makes their fitted values. O(size).
    double squares_of(const BandedQr& rows) const;

  private:
    /// Entries of row i: those of the band, then the border's.
    Extended* entries(Index i) { return factor_.data() + i * width_; }
    const Extended* entries(Index i) const { return factor_.data() + i * width_; }
    /// Calls `visit(column, value)` for the entries of row i from the diagonal on.
    template <class Visit>
    void visit_row(Index i, Visit visit) const;
    enum class Order { ascending, descending };
    /// Calls `visit(i, strand)` for each entry i of each strand of x along the axis.
    template <class Visit>
    void for_each_entry(Extended* x, AxisLayout layout, Order order, Visit visit) const;

    Index size_;
    Index border_;
    int degree_;
    Index width_;
    Index columns_;
    std::vector<Extended> factor_;
    std::vector<Extended> rhs_;
    std::vector<Extended> column_squares_;
    Extended left_over_ = 0;
};

} // namespace batten
