#include <batten/solve/banded_saddle.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten {

BandedSaddle::BandedSaddle(Index n, Closure closure, FunctionRef<void(Visit)> for_each_entry,
                           const Constraints& constraints) {
    place(n, closure, constraints);
    const auto position = [](const std::vector<Index>& of, Index i) {
        return of[static_cast<std::size_t>(i)];
    };
    const auto widen = [&](Index row, Index column) {
        below_ = std::max(below_, std::abs(row - column));
    };
    for_each_entry([&](Index row, Index column, Extended) {
        widen(position(controls_, row), position(controls_, column));
    });
    constraints.for_each_entry([&](Index row, Index control, double) {
        widen(position(multipliers_, row), position(controls_, control));
    });
    width_ = 3 * below_ + 1;
    band_.assign(static_cast<std::size_t>(size_ * width_), 0);
    for_each_entry([&](Index row, Index column, Extended value) {
        at(position(controls_, row), position(controls_, column)) += value;
    });
    constraints.for_each_entry([&](Index row, Index control, double value) {
        at(position(multipliers_, row), position(controls_, control)) += value;
        at(position(controls_, control), position(multipliers_, row)) += value;
    });
    factor();
}

void BandedSaddle::place(Index n, Closure closure, const Constraints& constraints) {
    const auto turn = [&](Index i) { // of control points
        if (closure == Closure::open) return i;
        return 2 * i < n ? 2 * i : 2 * (n - 1 - i) + 1;
    };
    std::vector<Index> last(static_cast<std::size_t>(constraints.size()), 0);
    constraints.for_each_entry([&](Index row, Index control, double) {
        Index& latest = last[static_cast<std::size_t>(row)];
        latest = std::max(latest, turn(control));
    });
    std::vector<Index> before(static_cast<std::size_t>(n) + 1, 0); // multipliers before a turn
    for (const Index t : last) ++before[static_cast<std::size_t>(t) + 1];
    for (std::size_t t = 1; t < before.size(); ++t) before[t] += before[t - 1];
    for (Index i = 0; i < n; ++i)
        controls_.push_back(turn(i) + before[static_cast<std::size_t>(turn(i))]);
    std::vector<Index> next(before.begin(), before.end() - 1);
    for (const Index t : last) multipliers_.push_back(t + 1 + next[static_cast<std::size_t>(t)]++);
    size_ = n + constraints.size();
}

void BandedSaddle::factor() {
    for (Index k = 0; k < size_; ++k) {
        const Index end = std::min(k + below_ + 1, size_);
        const Index reach = std::min(k + 2 * below_ + 1, size_);
        Index pivot = k;
        for (Index i = k + 1; i < end; ++i)
            if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
        pivots_.push_back(pivot);
        if (at(pivot, k) == 0)
            throw SolverError("what must hold, or the normal equations, are singular");
        if (pivot != k)
            for (Index j = k; j < reach; ++j) std::swap(at(k, j), at(pivot, j));
        for (Index i = k + 1; i < end; ++i) {
            if (at(i, k) == 0) continue;
            const Extended factor = at(i, k) /= at(k, k);
            for (Index j = k + 1; j < reach; ++j) at(i, j) -= factor * at(k, j);
        }
    }
}

PointSet BandedSaddle::multipliers(const PointSet& b) const {
    const Index dim = b.dim();
    std::vector<Extended> x(static_cast<std::size_t>(size_ * dim), 0);
    const auto row = [&](Index i) { return x.data() + i * dim; };
    const auto subtract = [&](Index to, Extended factor, Index from) {
        for (Index d = 0; d < dim; ++d) row(to)[d] -= factor * row(from)[d];
    };
    for (Index k = 0; k < b.size(); ++k)
        std::ranges::copy(b[k], row(multipliers_[static_cast<std::size_t>(k)]));
    for (Index k = 0; k < size_; ++k) {
        const Index pivot = pivots_[static_cast<std::size_t>(k)];
        if (pivot != k) std::swap_ranges(row(k), row(k) + dim, row(pivot));
        for (Index i = k + 1; i < std::min(k + below_ + 1, size_); ++i) subtract(i, at(i, k), k);
    }
    for (Index k = size_; k-- > 0;) {
        for (Index j = k + 1; j < std::min(k + 2 * below_ + 1, size_); ++j)
            subtract(k, at(k, j), j);
        for (Index d = 0; d < dim; ++d) row(k)[d] /= at(k, k);
    }
    PointSet y(b.size(), dim);
    for (Index k = 0; k < b.size(); ++k)
        for (Index d = 0; d < dim; ++d)
            y(k, d) = static_cast<double>(row(multipliers_[static_cast<std::size_t>(k)])[d]);
    return y;
}

} // namespace batten
