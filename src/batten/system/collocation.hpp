#pragma once

#include <batten/basis/active_functions.hpp>
#include <batten/core/points.hpp>

#include <optional>
#include <string>

namespace batten {

/// The collocation matrix of one axis, A(j, i) = B_i(t_j), (m x n) with n free control points:
/// degree + 1 consecutive entries a row (around the end of a closed axis).
class Collocation {
  public:
    /// Parameters need not be sorted. Throws InvalidInput when one lies outside an open domain.
    Collocation(const KnotVector& knots, std::span<const double> parameters);

    /// Rows made otherwise: per row its first column and degree + 1 values, (rows x (degree + 1)).
    Collocation(int degree, Index columns, std::vector<Index> first, std::vector<double> values)
        : degree_(degree),
          columns_(columns),
          first_(std::move(first)),
          values_(std::move(values)) {}

    Index rows() const { return static_cast<Index>(first_.size()); }
    Index columns() const { return columns_; }
    int degree() const { return degree_; }
    /// Column of entry r (0 to degree) of row j.
    Index column(Index j, int r) const {
        const Index c = first_[static_cast<std::size_t>(j)] + r;
        return c < columns_ ? c : c - columns_;
    }
    /// Row j as the active functions that it holds.
    ActiveFunctions row(Index j) const;
    /// Entry r (0 to degree) of row j.
    double value(Index j, int r) const {
        return values_[static_cast<std::size_t>(j * (degree_ + 1) + r)];
    }

    /// A x for x (n x dim): (m x dim).
    PointSet apply(const PointSet& x) const;
    /// A^T y for y (m x dim): (n x dim).
    PointSet apply_transposed(const PointSet& y) const;
    /// A along the middle axis of values (outer x n x inner): (outer x m x inner).
    std::vector<double> apply_along(const std::vector<double>& values, Index inner) const;
    /// A^T along the middle axis of values (outer x m x inner): (outer x n x inner).
    std::vector<double> apply_transposed_along(const std::vector<double>& values,
                                               Index inner) const;

  private:
    int degree_;
    Index columns_;
    std::vector<Index> first_;
    std::vector<double> values_;
};

/// Whether the samples at ascending `parameters` determine every control point of one axis (the
/// Schoenberg-Whitney conditions). Nothing when they do, else words that name the spans that lack
/// samples.
std::optional<std::string> undetermined(const KnotVector& knots,
                                        std::span<const double> parameters);

} // namespace batten
