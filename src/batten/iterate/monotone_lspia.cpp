#include <batten/iterate/monotone_lspia.hpp>

#include <batten/basis/basis_functions.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/system/row_sums.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// The nearest numbers that rise: means of neighbours that do not.
void pool_adjacent_violators(std::vector<double>& values) {
    struct Pool {
        double sum;
        double count;
        double mean() const { return sum / count; }
    };
    std::vector<Pool> pools;
    for (double value : values) {
        pools.push_back({value, 1});
        while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
            const Pool last = pools.back();
            pools.pop_back();
            pools.back().sum += last.sum;
            pools.back().count += last.count;
        }
    }
    std::size_t at = 0;
    for (const Pool& pool : pools)
        for (double k = 0; k < pool.count; ++k) values[at++] = pool.mean();
}

/// The sign of the slope, per coordinate, of the weighted regression line of the samples over their
/// parameters: control points at the Greville abscissae make the parameter itself.
std::vector<int> slopes(const NormalSystem& system, const std::vector<double>& sums) {
    const std::vector<double> greville = greville_abscissae(system.axes()[0]);
    double weight = 0;
    double moment = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        weight += sums[i];
        moment += greville[i] * sums[i];
    }
    std::vector<int> signs;
    for (Index d = 0; d < system.dim(); ++d) {
        double slope = 0;
        for (Index i = 0; i < system.size(); ++i)
            slope += (greville[static_cast<std::size_t>(i)] - moment / weight) * system.rhs()(i, d);
        signs.push_back(slope < 0 ? -1 : 1);
    }
    return signs;
}

} // namespace

MonotoneLspia::MonotoneLspia(const NormalSystem& system, Choice choice)
    : system_(system), choice_(choice) {}

void MonotoneLspia::start(PointSet& control) {
    constexpr double inside = 0.99;
    const std::vector<double> sums = row_sums(system_);
    const double limit = 2 / std::ranges::max(sums);
    mu_ = choice_.mu.value_or(inside * limit);
    check_setting("monotone-lspia", "mu", mu_, {.low = 0, .high = limit},
                  "its region of convergence");
    if (choice_.coordinate && *choice_.coordinate >= system_.dim())
        throw InvalidInput(fmt::format("setting coordinate = {} of method monotone-lspia: the "
                                       "points have {} coordinates, counted from 0",
                                       *choice_.coordinate, system_.dim()));
    directions_ = slopes(system_, sums);
    for (Index d = 0; d < system_.dim(); ++d) {
        int& direction = directions_[static_cast<std::size_t>(d)];
        if (choice_.coordinate && *choice_.coordinate != d)
            direction = 0;
        else if (choice_.direction != 0)
            direction = choice_.direction;
    }
    project(control);
}

void MonotoneLspia::project(PointSet& control) const {
    std::vector<double> values(static_cast<std::size_t>(control.size()));
    for (Index d = 0; d < control.dim(); ++d) {
        const int direction = directions_[static_cast<std::size_t>(d)];
        if (direction == 0) continue;
        for (Index i = 0; i < control.size(); ++i)
            values[static_cast<std::size_t>(i)] = direction * control(i, d);
        pool_adjacent_violators(values);
        for (Index i = 0; i < control.size(); ++i)
            control(i, d) = direction * values[static_cast<std::size_t>(i)];
    }
}

const PointSet& MonotoneLspia::propose(const PointSet& control) {
    moves_ = control;
    add_scaled(moves_, mu_, system_.gradient(control));
    project(moves_);
    add_scaled(moves_, -1.0, control);
    norm_ = frobenius_norm(moves_) / mu_;
    return moves_;
}

} // namespace batten
