#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>

#include <string>
#include <utility>
#include <vector>

namespace batten {

/// Linear equalities C P = d that a fit must meet exactly: one row per constraint, sparse over the
/// control points.
class Constraints {
  public:
    explicit Constraints(Index dim = 0) : values_(0, dim) {}

    Index size() const { return static_cast<Index>(rows_.size()); }
    bool empty() const { return rows_.empty(); }
    /// Right-hand sides d, (k x dim).
    const PointSet& values() const { return values_; }
    const std::string& name(Index row) const { return names_[static_cast<std::size_t>(row)]; }

    /// Whether the row is of a position, not of a derivative.
    bool is_position(Index row) const { return sums_[static_cast<std::size_t>(row)] > 0.5; }

    /// Adds: the derivative of the given orders (0 each: the point) at `parameter` equals `value`.
    /// `name` is what messages call it.
    void add(const std::vector<KnotVector>& axes, std::span<const double> parameter,
             std::span<const int> orders, std::span<const double> value, std::string name);
    /// Adds: the derivative of the given orders at `parameter` has the direction `direction`; its
    /// length is free until it is given by `with_lengths`.
    void add_direction(const std::vector<KnotVector>& axes, std::span<const double> parameter,
                       std::span<const int> orders, std::span<const double> direction,
                       std::string name);
    /// Adds: the free control point of the given index is `value`.
    void fix(Index control, std::span<const double> value, std::string name);
    /// Adds: parts of control points, by their indices, add up to `value`.
    void add_parts(std::span<const std::pair<Index, double>> parts, std::span<const double> value,
                   std::string name);
    /// Rows whose value has a direction only.
    const std::vector<Index>& directions() const { return directions_; }
    /// The same constraints with lengths given to the directions, in order: none is left free.
    Constraints with_lengths(std::span<const double> lengths) const;

    /// The same constraints, those of derivatives divided by the length of their rows: what they
    /// lack is then as long as control points are away.
    Constraints balanced() const;

    /// Calls `visit(row, control, value)` for the entries of C.
    template <class Visit>
    void for_each_entry(Visit visit) const {
        for (Index k = 0; k < size(); ++k)
            for (const Entry& entry : rows_[static_cast<std::size_t>(k)])
                visit(k, entry.control, entry.value);
    }
    /// C P: (k x dim).
    PointSet apply(const PointSet& control) const;
    /// C^T y: (n x dim) for n control points.
    PointSet apply_transposed(const PointSet& y, Index controls) const;
    /// The same constraints for control points and values relative to `centre` (rows of positions
    /// only shift).
    Constraints centred(const std::vector<double>& centre) const;

    /// The constraints without those that follow from the others. Throws ConstraintConflict when
    /// more than `controls` are left, or some contradict each other: then a smallest such set is
    /// named. Where a sparse factor of C C^T shows that none does, that is all it costs.
    Constraints independent(Index controls) const;

  private:
    /// Whether rows of unit length are certainly independent, by Cholesky's factor of C C^T.
    bool certainly_independent(Index controls) const;
    struct Entry {
        Index control;
        double value;
    };
    std::vector<std::vector<Entry>> rows_;
    std::vector<double> sums_; // of a row's entries: 1 for a position, 0 for a derivative
    /// Names the rows that row `last`, a combination of them with the parts `how`, contradicts;
    /// empty when it follows from them.
    std::string clash_words(std::span<const double> how, Index last) const;
    void add_row(std::vector<Entry> row, double sum, std::span<const double> value,
                 std::string name);

    std::vector<std::string> names_;
    std::vector<Index> directions_;
    PointSet values_;
};

/// Throws InvalidInput for an index that is not of so many samples, or given twice.
void check_interpolated(const std::vector<Index>& indices, Index samples);

/// The samples with the given indices as position constraints at their own parameters.
/// Throws InvalidInput for an index out of range or given twice.
Constraints interpolate_samples(const std::vector<KnotVector>& axes, const Samples& samples,
                                const Parameters& parameters, const std::vector<Index>& indices);

} // namespace batten
