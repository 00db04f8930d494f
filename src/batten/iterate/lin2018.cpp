#include <batten/iterate/lin2018.hpp>

#include <batten/system/row_sums.hpp>

#include <algorithm>

namespace batten {

std::vector<double> diagonal_steps(const NormalSystem& system) {
    constexpr double rounding = 1e-12;
    std::vector<double> steps = row_sums(system);
    const double least = rounding * std::ranges::max(steps);
    for (double& x : steps) x = x > least ? 1 / x : 0;
    return steps;
}

void Lin2018::start(PointSet&) {
    steps_ = diagonal_steps(system_);
}

const PointSet& Lin2018::propose(const PointSet& control) {
    moves_ = system_.gradient(control);
    for (Index i = 0; i < moves_.size(); ++i)
        if (steps_[static_cast<std::size_t>(i)] == 0) std::ranges::fill(moves_[i], 0.0);
    norm_ = frobenius_norm(moves_);
    for (Index i = 0; i < moves_.size(); ++i)
        for (double& x : moves_[i]) x *= steps_[static_cast<std::size_t>(i)];
    return moves_;
}

} // namespace batten
