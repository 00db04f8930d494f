#include <batten/system/collocation.hpp>
#include <batten/system/half_stencil.hpp>
#include <batten/system/system_sums.hpp>

#include <batten/spline/spline.hpp>

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <optional>

namespace batten {

namespace {

/// The coordinate in which a coarse control point is told apart from the p others that one of the
/// finer ones depends on: by turns, and around the end of a closed axis each in one of its own.
struct Turns {
    explicit Turns(const KnotVector& coarse)
        : width(coarse.degree() + 1),
          regular(coarse.closed() ? coarse.free_count() / width * width : coarse.free_count()),
          count(width + coarse.free_count() - regular) {}

    Index operator()(Index control) const {
        return control < regular ? control % width : width + control - regular;
    }

    Index width;
    Index regular;
    Index count;
};

/// The matrix T that inserts knots, (n x n') for n free control points from n' coarse ones: a row
/// has p + 1 consecutive entries, as B-splines of a collocation have.
Collocation inserting(const KnotVector& coarse, const KnotVector& fine) {
    const Turns turns(coarse);
    const Index columns = coarse.free_count();
    PointSet units(columns, turns.count);
    for (Index i = 0; i < columns; ++i) units(i, turns(i)) = 1;
    const PointSet rows = refine(Spline::from_free({coarse}, units), 0, fine).free_control_points();
    std::vector<Index> first;
    std::vector<double> values;
    for (Index i = 0; i < rows.size(); ++i) {
        // those whose support holds that of the fine one
        Index begin = std::ranges::upper_bound(coarse.knots(), fine[i]) - coarse.knots().begin() -
                      turns.width;
        begin = coarse.closed() ? (begin + columns) % columns
                                : std::clamp<Index>(begin, 0, columns - turns.width);
        first.push_back(begin);
        for (Index r = 0; r < turns.width; ++r)
            values.push_back(rows(i, turns((begin + r) % columns)));
    }
    return {coarse.degree(), columns, std::move(first), std::move(values)};
}

/// Along an axis from `row` to `column` in the fewest steps, along a closed one forwards where both
/// ways are as far and `row` comes first.
Index steps(const KnotVector& axis, Index row, Index column) {
    if (!axis.closed()) return column - row;
    const Index n = axis.free_count();
    const Index forwards = (column - row + n) % n;
    return forwards < n - forwards || (forwards == n - forwards && row < column) ? forwards
                                                                                 : forwards - n;
}

/// T^T M T; what is beyond the band is zero, for coarse B-splines without common samples have no
/// fine ones with them.
BandedMatrix coarse_matrix(const BandedMatrix& matrix, const KnotVector& coarse,
                           const Collocation& t) {
    BandedMatrix result(coarse.free_count(), coarse.degree(), coarse.closure());
    matrix.for_each_entry([&](Index i, Index j, double value) {
        for (int r = 0; r <= t.degree(); ++r)
            for (int s = 0; s <= t.degree(); ++s) {
                const Index row = t.column(i, r);
                const Index step = steps(coarse, row, t.column(j, s));
                if (step >= 0 && step <= coarse.degree())
                    result.at(row, static_cast<int>(step)) += value * t.value(i, r) * t.value(j, s);
            }
    });
    return result;
}

/// A stencil taken to coarser knots along one axis.
class StencilAlong {
  public:
    StencilAlong(const std::vector<KnotVector>& fine, const std::vector<KnotVector>& coarse,
                 std::size_t axis, const Collocation& t)
        : fine_(fine),
          coarse_(coarse),
          axis_(axis),
          t_(t),
          controls_(free_shape(fine)),
          to_controls_(free_shape(coarse)),
          to_places_(half_stencil(coarse)),
          result_(
              static_cast<std::size_t>(GridIndex{to_places_.size(), to_controls_.size()}.size())) {}

    std::vector<double> operator()(const std::vector<double>& stencil) {
        half_stencil(fine_).for_each([&](const GridIndex::Place& place, Index p) {
            const GridIndex::Place offset = half_stencil_offset(fine_, place);
            controls_.for_each([&](const GridIndex::Place& at, Index i) {
                const double value = stencil[static_cast<std::size_t>(p * controls_.size() + i)];
                if (value == 0) return;
                add(at, offset, value);
                if (axis_ == 0 && offset[0] > 0) add_mirrored(at, offset, value);
            });
        });
        return std::move(result_);
    }

  private:
    /// The same entry seen from the other control point.
    void add_mirrored(GridIndex::Place at, GridIndex::Place offset, double value) {
        for (std::size_t k = 0; k < fine_.size(); ++k) {
            at[k] = around(at[k] + offset[k], controls_.length(k));
            offset[k] = -offset[k];
        }
        add(at, offset, value);
    }

    void add(GridIndex::Place at, GridIndex::Place offset, double value) {
        const Index row = at[axis_];
        const Index column = around(row + offset[axis_], controls_.length(axis_));
        const Index most = coarse_[axis_].degree();
        const Index least = axis_ == 0 ? 0 : -most; // of axis 0 only one half is stored
        for (int r = 0; r <= t_.degree(); ++r) {
            at[axis_] = t_.column(row, r);
            const double part = value * t_.value(row, r);
            if (part == 0) continue;
            for (int s = 0; s <= t_.degree(); ++s) {
                offset[axis_] = steps(coarse_[axis_], at[axis_], t_.column(column, s));
                if (offset[axis_] < least || offset[axis_] > most) continue;
                const Index place = to_places_.at(half_stencil_place(coarse_, offset));
                result_[static_cast<std::size_t>(place * to_controls_.size() +
                                                 to_controls_.at(at))] +=
                    part * t_.value(column, s);
            }
        }
    }

    static Index around(Index i, Index count) { return (i + count) % count; }

    const std::vector<KnotVector>& fine_;
    const std::vector<KnotVector>& coarse_;
    std::size_t axis_;
    const Collocation& t_;
    GridIndex controls_;
    GridIndex to_controls_;
    GridIndex to_places_;
    std::vector<double> result_;
};

SystemSums coarsened_along(SystemSums sums, std::size_t axis, const KnotVector& coarse) {
    const Collocation t = inserting(coarse, sums.axes[axis]);
    const GridIndex controls(free_shape(sums.axes));
    const Index inner = controls.stride(axis) * sums.rhs.dim();
    sums.rhs = PointSet(t.apply_transposed_along(sums.rhs.values(), inner), sums.rhs.dim());
    for (auto* matrices : {&sums.factors, &sums.axis_sums, &sums.grid_means})
        if (!matrices->empty()) (*matrices)[axis] = coarse_matrix((*matrices)[axis], coarse, t);
    std::vector<KnotVector> axes = sums.axes;
    axes[axis] = coarse;
    if (!sums.stencil.empty()) sums.stencil = StencilAlong(sums.axes, axes, axis, t)(sums.stencil);
    sums.axes = std::move(axes);
    return sums;
}

/// Whether one knot vector's spline space holds another's.
bool nested(const KnotVector& coarse, const KnotVector& fine) {
    if (coarse.degree() != fine.degree()) return false;
    try {
        const PointSet any(coarse.free_count(), 1);
        refine(Spline::from_free({coarse}, any), 0, fine);
        return true;
    } catch (const InvalidInput&) {
        return false;
    }
}

} // namespace

SystemSums coarsened(SystemSums sums, const std::vector<KnotVector>& axes) {
    if (axes.size() != sums.axes.size())
        throw InvalidInput(
            fmt::format("knots: {} vectors given for {} axes", axes.size(), sums.axes.size()));
    for (std::size_t k = 0; k < axes.size(); ++k)
        if (!nested(axes[k], sums.axes[k]))
            throw InvalidInput(fmt::format("axis {}: the knots are not nested in the system's, of "
                                           "degree {} with {} control points",
                                           k, sums.axes[k].degree(), sums.axes[k].free_count()));
    for (std::size_t k = 0; k < axes.size(); ++k)
        if (axes[k] != sums.axes[k]) sums = coarsened_along(std::move(sums), k, axes[k]);
    return sums;
}

} // namespace batten
