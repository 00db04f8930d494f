#include <batten/iterate/accelerated.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>

#include <cmath>

namespace batten {

namespace {

/// Eigenvalues known to a tolerance only, widened so that the interval surely holds the spectrum.
ExtremeEigenvalues widened(const StepGradient& gradient) {
    const ExtremeEigenvalues& e = gradient.eigenvalues().values;
    const double tolerance = gradient.tolerance();
    return {e.largest * (1 + tolerance), e.smallest * (1 - tolerance)};
}

} // namespace

Chebyshev::Chebyshev(const NormalSystem& system, double eigenvalue_tolerance, RowSums row_sums)
    : gradient_(system, row_sums, eigenvalue_tolerance) {}

void Chebyshev::start(PointSet&) {
    check_setting("chebyshev", "eigenvalue_tolerance", gradient_.tolerance());
    gradient_.start();
    setup_products_ = gradient_.setup_products();
    const ExtremeEigenvalues e = widened(gradient_);
    centre_ = (e.largest + e.smallest) / 2;
    radius_ = (e.largest - e.smallest) / 2;
    const double root = std::sqrt(e.largest / e.smallest);
    rate_ = gradient_.eigenvalues().raised() ? 0 : (root - 1) / (root + 1);
    last_ = {};
}

const PointSet& Chebyshev::propose(const PointSet& control) {
    moves_ = gradient_.at(control);
    if (last_.empty()) {
        rho_ = radius_ / centre_;
        scale(moves_.values(), 1 / centre_);
        return moves_;
    }
    // three-term recurrence: rho' = 1 / (2 centre / radius - rho), move' = rho' rho move + 2 rho' /
    // radius gradient
    if (!(radius_ > 0)) { // one eigenvalue only
        scale(moves_.values(), 1 / centre_);
        return moves_;
    }
    const double next = 1 / (2 * centre_ / radius_ - rho_);
    scale(moves_.values(), 2 * next / radius_);
    add_scaled(moves_, next * rho_, last_);
    rho_ = next;
    return moves_;
}

Nesterov::Nesterov(const NormalSystem& system, double eigenvalue_tolerance, std::string_view name,
                   RowSums row_sums)
    : gradient_(system, row_sums, eigenvalue_tolerance), name_(name) {}

void Nesterov::start(PointSet&) {
    check_setting(name_, "eigenvalue_tolerance", gradient_.tolerance());
    gradient_.start();
    setup_products_ = gradient_.setup_products();
    const ExtremeEigenvalues e = widened(gradient_);
    step_ = 1 / e.largest;
    const double root = std::sqrt(e.largest / e.smallest);
    momentum_ = (root - 1) / (root + 1);
}

const PointSet& Nesterov::propose(const PointSet& control) {
    moves_ = gradient_.at(control);
    // the gradient ahead, at y = P + momentum * (last move), is linear in the move
    if (!last_.empty()) add_scaled(moves_, -momentum_, gradient_.image(last_));
    scale(moves_.values(), step_);
    if (!last_.empty()) add_scaled(moves_, momentum_, last_);
    return moves_;
}

BarzilaiBorwein::BarzilaiBorwein(const NormalSystem& system, int memory)
    : system_(system), search_(memory) {}

void BarzilaiBorwein::start(PointSet&) {
    check_setting("barzilai-borwein", "memory", search_.memory());
    image_ = PointSet(system_.size(), system_.dim());
    moves_image_ = image_;
    search_.start();
    step_ = 0;
}

const PointSet& BarzilaiBorwein::propose(const PointSet& control) {
    gradient_ = system_.gradient(control);
    const double square = inner_product(gradient_, gradient_);
    norm_ = std::sqrt(square);
    system_.apply(gradient_, image_);
    const double curvature = inner_product(gradient_, image_);
    if (step_ == 0) step_ = curvature > 0 ? square / curvature : 0;
    step_ = search_.searched(step_, square, curvature);
    moves_ = gradient_;
    scale(moves_.values(), step_);
    return moves_;
}

void BarzilaiBorwein::accept(const PointSet& moves) {
    system_.apply(moves, moves_image_);
    const double length = inner_product(moves, moves);
    const double curvature = inner_product(moves, moves_image_);
    search_.moved(curvature / 2 - inner_product(moves, gradient_));
    step_ = curvature > 0 ? length / curvature : 0;
}

} // namespace batten
