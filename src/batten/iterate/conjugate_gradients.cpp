#include <batten/iterate/conjugate_gradients.hpp>

#include <batten/core/vectors.hpp>

namespace batten {

ConjugateGradients::ConjugateGradients(const NormalSystem& system, Preconditioner preconditioner)
    : system_(system), preconditioner_(preconditioner) {}

void ConjugateGradients::start(PointSet&) {
    preconditioning_ = Preconditioning(system_, preconditioner_);
    image_ = PointSet(system_.size(), system_.dim());
    fresh_ = true;
}

const PointSet& ConjugateGradients::propose(const PointSet& control) {
    if (fresh_) gradient_ = system_.gradient(control);
    norm_ = frobenius_norm(gradient_);
    PointSet scaled = gradient_;
    preconditioning_.apply(scaled);
    const double energy = inner_product(gradient_, scaled);
    if (!fresh_) add_scaled(scaled, energy / energy_, direction_);
    direction_ = std::move(scaled);
    energy_ = energy;
    system_.apply(direction_, image_);
    const double curvature = inner_product(direction_, image_);
    step_ = curvature > 0 ? energy_ / curvature : 0;
    moves_ = direction_;
    scale(moves_.values(), step_);
    fresh_ = false;
    return moves_;
}

void ConjugateGradients::accept(const PointSet& moves) {
    if (moves.values() != moves_.values()) { // limited steps break the conjugacy
        fresh_ = true;
        return;
    }
    add_scaled(gradient_, -step_, image_);
}

} // namespace batten
