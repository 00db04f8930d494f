#include <batten/solve/banded_qr.hpp>

#include <batten/core/core.hpp>
#include <batten/solve/tail_norm.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

/// The entries of one strand along the axis.
struct Strand {
    Extended* first;
    Index stride;

    Extended& operator[](Index i) const { return first[i * stride]; }
};

} // namespace

BandedQr::BandedQr(Index size, int degree, Closure closure, Index rhs_columns)
    : size_(size),
      border_(closure == Closure::closed ? degree : 0),
      degree_(degree),
      width_(degree + 1 + border_),
      columns_(rhs_columns),
      factor_(static_cast<std::size_t>(size * width_)),
      rhs_(static_cast<std::size_t>(size * rhs_columns)),
      column_squares_(static_cast<std::size_t>(size)) {}

BandedRow BandedQr::row(const ActiveFunctions& active, Extended factor) const {
    const Index inner = inner_size();
    BandedRow result;
    result.lead = lead(active.first);
    for (int r = 0; r <= degree_; ++r) {
        const Index column = active.index(r);
        const Extended value = factor * Extended(active.value[static_cast<std::size_t>(r)]);
        if (column < inner)
            result.band[static_cast<std::size_t>(column - result.lead)] = value;
        else
            result.border[static_cast<std::size_t>(column - inner)] = value;
    }
    return result;
}

BandedRow BandedQr::row(Index i) const {
    BandedRow result;
    const Extended* from = entries(i);
    result.lead = std::min(i, inner_size());
    if (i < inner_size()) std::copy_n(from, degree_ + 1, result.band.begin());
    std::copy_n(from + degree_ + 1, border_, result.border.begin());
    return result;
}

void BandedQr::add(BandedRow row, Extended* rhs) {
    const Index inner = inner_size();
    auto& v = row.band;
    for (Index k = 0; k <= degree_ && row.lead + k < inner; ++k) {
        const Extended x = v[static_cast<std::size_t>(k)];
        column_squares_[static_cast<std::size_t>(row.lead + k)] += x * x;
    }
    for (Index c = 0; c < border_; ++c) {
        const Extended x = row.border[static_cast<std::size_t>(c)];
        column_squares_[static_cast<std::size_t>(inner + c)] += x * x;
    }
    const auto rotate_rest = [&](const Rotation& turn, Index i, Index border_from) {
        Extended* kept = entries(i) + degree_ + 1;
        for (Index c = border_from; c < border_; ++c)
            turn.apply(kept[c], row.border[static_cast<std::size_t>(c)]);
        Extended* right = rhs_.data() + i * columns_;
        for (Index d = 0; d < columns_; ++d) turn.apply(right[d], rhs[d]);
    };
    const Index end = std::min(row.lead + degree_ + 1, inner); // rows below are empty as yet
    for (Index i = row.lead; i < end; ++i) {
        if (v[0] != 0) {
            Extended* kept = entries(i);
            const Rotation turn(kept[0], v[0]);
            for (Index k = 0; k <= degree_; ++k)
                turn.apply(kept[k], v[static_cast<std::size_t>(k)]);
            rotate_rest(turn, i, 0);
        }
        std::shift_left(v.begin(), v.begin() + degree_ + 1, 1);
        v[static_cast<std::size_t>(degree_)] = 0;
    }
    for (Index c = 0; c < border_; ++c)
        if (const Extended x = row.border[static_cast<std::size_t>(c)]; x != 0)
            rotate_rest(Rotation(entries(inner + c)[degree_ + 1 + c], x), inner + c, c);
    for (Index d = 0; d < columns_; ++d) left_over_ += rhs[d] * rhs[d];
}

void BandedQr::merge(const std::vector<BandedQr>& others) {
    std::vector<Extended> right(static_cast<std::size_t>(columns_));
    for (Index i = 0; i < size_; ++i)
        for (const BandedQr& other : others) {
            std::ranges::copy(other.rotated(i), right.begin());
            add(other.row(i), right.data());
        }
    for (const BandedQr& other : others) left_over_ += other.left_over_;
}

void BandedQr::check() const {
    constexpr Extended least = 1e-15L; // of the column: below it rounding made what is left
    for (Index i = 0; i < size_; ++i) {
        const Extended pivot = entries(i)[i < inner_size() ? 0 : degree_ + 1 + i - inner_size()];
        if (!(std::abs(pivot) > least * std::sqrt(column_squares_[static_cast<std::size_t>(i)])))
            throw SolverError(fmt::format("the least-squares problem is singular: control point {} "
                                          "is not determined by the samples",
                                          i));
    }
}

template <class Visit>
void BandedQr::visit_row(Index i, Visit visit) const {
    const Extended* row = entries(i);
    const Index inner = inner_size();
    for (Index k = 0; k <= degree_ && i + k < inner; ++k) visit(i + k, row[k]);
    for (Index c = std::max<Index>(0, i - inner); c < border_; ++c)
        visit(inner + c, row[degree_ + 1 + c]);
}

template <class Visit>
void BandedQr::for_each_entry(Extended* x, AxisLayout layout, Order order, Visit visit) const {
    for_each_chunk(layout.outer, [&](Index o) {
        for (Index k = 0; k < size_; ++k)
            for (Index d = 0; d < layout.inner; ++d)
                visit(order == Order::ascending ? k : size_ - 1 - k,
                      Strand{x + o * size_ * layout.inner + d, layout.inner});
    });
}

void BandedQr::apply(Extended* x, AxisLayout layout) const {
    for_each_entry(x, layout, Order::ascending, [&](Index i, Strand at) {
        Extended sum = 0;
        visit_row(i, [&](Index j, Extended value) { sum += value * at[j]; });
        at[i] = sum;
    });
}

void BandedQr::apply_transposed(Extended* x, AxisLayout layout) const {
    for_each_entry(x, layout, Order::descending, [&](Index i, Strand at) {
        const Extended from = std::exchange(at[i], 0);
        visit_row(i, [&](Index j, Extended value) { at[j] += value * from; });
    });
}

void BandedQr::solve(Extended* x, AxisLayout layout) const {
    for_each_entry(x, layout, Order::descending, [&](Index i, Strand at) {
        Extended sum = at[i];
        Extended pivot = 1;
        visit_row(i, [&](Index j, Extended value) {
            if (j == i)
                pivot = value;
            else
                sum -= value * at[j];
        });
        at[i] = sum / pivot;
    });
}

void BandedQr::solve_transposed(Extended* x, AxisLayout layout) const {
    for_each_entry(x, layout, Order::ascending, [&](Index i, Strand at) {
        Extended from = 0;
        visit_row(i, [&](Index j, Extended value) {
            if (j == i)
                from = at[i] /= value;
            else
                at[j] -= value * from;
        });
    });
}

void BandedQr::for_each_product(FunctionRef<void(Index, Index, Extended)> visit) const {
    for (Index i = 0; i < size_; ++i)
        visit_row(i, [&](Index j, Extended a) {
            visit_row(i, [&](Index k, Extended b) { visit(j, k, a * b); });
        });
}

double BandedQr::squares_of(const BandedQr& rows) const {
    const Index inner = inner_size();
    TailNorm tail(degree_, border_);
    for (Index c = border_; c-- > 0;) tail.prepend_border(c, entries(inner + c) + degree_ + 1);
    Extended sum = 0;
    for (Index i = size_; i-- > inner;)
        sum += tail.squares_of_border(rows.entries(i) + degree_ + 1);
    for (Index i = inner; i-- > 0;) {
        sum += tail.squares_of(entries(i), rows.entries(i));
        tail.prepend(entries(i));
    }
    return static_cast<double>(sum);
}

} // namespace batten
