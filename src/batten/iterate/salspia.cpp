#include <batten/iterate/salspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/system/row_sums.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The positive root of (1 - w) c a^2 + (2 w - 1) b a - w rho = 0: w = 1 gives rho / b, 0 b / c.
double blended(double w, double rho, double b, double c) {
    constexpr double nothing = 1e-30;
    const double x = (1 - w) * c;
    const double y = (2 * w - 1) * b;
    if (x <= nothing * c) return rho / b;
    const double root = std::sqrt(std::max(0.0, y * y + 4 * x * w * rho));
    return y < 0 ? (root - y) / (2 * x) : 2 * w * rho / (y + root);
}

} // namespace

Salspia::Salspia(const NormalSystem& system, int memory, SpectralStep kind)
    : system_(system), search_(memory), kind_(kind) {}

void Salspia::start(PointSet&) {
    check_setting("salspia", "memory", search_.memory());
    bound_ = std::ranges::max(row_sums(system_));
    image_ = PointSet(system_.size(), system_.dim());
    step_ = 0;
    search_.start();
}

const PointSet& Salspia::propose(const PointSet& control) {
    gradient_ = system_.gradient(control);
    rho_ = inner_product(gradient_, gradient_);
    step_ = step_ == 0 ? 1 / bound_ : searched(trial(inner_product(last_gradient_, gradient_)));
    moves_ = gradient_;
    scale(moves_.values(), step_);
    return moves_;
}

/// The step that suits the last gradient g, by how it changed to the one at hand.
double Salspia::trial(double zeta) const {
    constexpr double nearly = 1e-8;
    const double b = (last_rho_ - zeta) / step_;                      // <g, H g>
    const double c = (last_rho_ - 2 * zeta + rho_) / (step_ * step_); // <H g, H g>
    if (!(b > 0) || !(c > 0)) return 1 / bound_;
    if (kind_ == SpectralStep::longer) return last_rho_ / b;
    if (kind_ == SpectralStep::shorter) return b / c;
    const double place = std::clamp(b / (bound_ * last_rho_), 0.0, 1.0); // in the spectrum
    return 1 - place <= nearly ? b / c : blended(1 - place, last_rho_, b, c);
}

double Salspia::searched(double step) {
    system_.apply(gradient_, image_);
    return search_.searched(step, rho_, inner_product(gradient_, image_));
}

void Salspia::accept(const PointSet& moves) {
    const bool as_proposed = moves.values() == moves_.values();
    system_.apply(moves, image_);
    search_.moved(inner_product(moves, image_) / 2 - inner_product(moves, gradient_));
    last_rho_ = rho_;
    std::swap(last_gradient_, gradient_);
    if (!as_proposed) step_ = 0; // a limited move says nothing of the spectrum
}

double Salspia::gradient_norm() const {
    return std::sqrt(rho_);
}

Settings Salspia::settings() const {
    return {{"memory", static_cast<double>(search_.memory())},
            {"step", step_},
            {"halvings", static_cast<double>(search_.halvings())}};
}

} // namespace batten
