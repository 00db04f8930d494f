#include <batten/iterate/conjugate_gradients.hpp>

namespace batten {

ConjugateGradients::ConjugateGradients(const NormalSystem& system, Preconditioner preconditioner)
    : system_(system), preconditioner_(preconditioner) {}

void ConjugateGradients::start(PointSet&) {
    if (preconditioner_ != Preconditioner::none) {
        inverse_diagonal_ = system_.diagonal();
        for (double& x : inverse_diagonal_) x = x > 0 ? 1 / x : 0;
    }
    if (preconditioner_ == Preconditioner::axes) axes_ = factorize_axes(system_);
    image_ = PointSet(system_.size(), system_.dim());
    fresh_ = true;
}

const PointSet& ConjugateGradients::propose(const PointSet& control) {
    if (fresh_) gradient_ = system_.gradient(control);
    norm_ = frobenius_norm(gradient_);
    PointSet scaled = gradient_;
    precondition(scaled);
    const double energy = inner_product(gradient_, scaled);
    if (!fresh_) add_scaled(scaled, energy / energy_, direction_);
    direction_ = std::move(scaled);
    energy_ = energy;
    system_.apply(direction_, image_);
    const double curvature = inner_product(direction_, image_);
    step_ = curvature > 0 ? energy_ / curvature : 0;
    moves_ = direction_;
    for (double& x : moves_.values()) x *= step_;
    fresh_ = false;
    return moves_;
}

void ConjugateGradients::precondition(PointSet& x) const {
    const auto on_rows = [&](auto factor) {
        for (Index i = 0; i < x.size(); ++i) {
            const double f = factor(inverse_diagonal_[static_cast<std::size_t>(i)]);
            for (double& value : x[i]) value *= f;
        }
    };
    if (axes_) {
        x = axes_->solve(std::move(x));
        on_rows([](double d) { return d > 0 ? 1.0 : 0.0; }); // control points without samples stay
    } else if (!inverse_diagonal_.empty()) {
        on_rows([](double d) { return d; });
    }
}

void ConjugateGradients::accept(const PointSet& moves) {
    if (moves.values() != moves_.values()) { // limited steps break the conjugacy
        fresh_ = true;
        return;
    }
    add_scaled(gradient_, -step_, image_);
}

} // namespace batten
