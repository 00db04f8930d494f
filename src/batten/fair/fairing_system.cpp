#include <batten/fair/fairing_system.hpp>

#include <batten/system/row_sums.hpp>

#include <algorithm>

namespace batten {

FairingSystem::FairingSystem(const Spline& spline, int order)
    : StencilSystem(spline.axes(), std::vector<double>(static_cast<std::size_t>(spline.dim()), 0)) {
    add_thin_plate(order);
    const PointSet control = spline.free_control_points();
    const auto first = control[0]; // D knows no shift
    const PointSet away = centred(control, {first.begin(), first.end()});
    pull_ = PointSet(size(), dim());
    apply(away, pull_);
    energy_ = inner_product(away, pull_);
    rhs_ = pull_;
    for (double& x : rhs_.values()) x = -x;
}

double FairingSystem::energy(const PointSet& moves) const {
    PointSet image(size(), dim());
    apply(moves, image);
    for (Index i = 0; i < size(); ++i)
        for (Index d = 0; d < dim(); ++d)
            image(i, d) += 2 * pull_(i, d) - anchors_[static_cast<std::size_t>(i)] * moves(i, d);
    return energy_ + inner_product(moves, image);
}

std::vector<double> FairingSystem::gains() const {
    std::vector<double> result = diagonal();
    for (Index i = 0; i < size(); ++i) {
        double& gain = result[static_cast<std::size_t>(i)];
        double square = 0;
        for (double x : pull_[i]) square += x * x;
        gain = gain > 0 ? square / gain : 0; // D_ii |P_i - best|^2
    }
    return result;
}

void FairingSystem::weigh(const std::vector<double>& weights) {
    constexpr double rounding = 1e-16; // moves in parts of what the others pull
    const std::vector<double> sums = row_sums(*this);
    anchors_.assign(weights.size(), 0);
    std::vector<char> held(weights.size(), 1);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double w = weights[i];
        if (!(w * sums[i] > rounding * (1 - w))) continue;
        held[i] = 0;
        anchors_[i] = (1 - w) / w;
    }
    add_diagonal(anchors_, held);
    for (Index i = 0; i < size(); ++i)
        if (held[static_cast<std::size_t>(i)] != 0) std::ranges::fill(rhs_[i], 0.0);
}

} // namespace batten
