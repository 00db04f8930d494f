#include <batten/iterate/lin2018.hpp>

#include <batten/core/vectors.hpp>
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

PointSet reached_gradient(const NormalSystem& system, const PointSet& control,
                          const std::vector<double>& steps) {
    PointSet gradient = system.gradient(control);
    for (Index i = 0; i < gradient.size(); ++i)
        if (steps[static_cast<std::size_t>(i)] == 0) std::ranges::fill(gradient[i], 0.0);
    return gradient;
}

void scale_rows(PointSet& rows, const std::vector<double>& factors) {
    for (Index i = 0; i < rows.size(); ++i) scale(rows[i], factors[static_cast<std::size_t>(i)]);
}

void Lin2018::start(PointSet&) {
    steps_ = diagonal_steps(system_);
}

const PointSet& Lin2018::propose(const PointSet& control) {
    moves_ = reached_gradient(system_, control, steps_);
    norm_ = frobenius_norm(moves_);
    scale_rows(moves_, steps_);
    return moves_;
}

} // namespace batten
