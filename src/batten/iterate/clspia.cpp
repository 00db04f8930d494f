#include <batten/iterate/clspia.hpp>

#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <cmath>
#include <fmt/format.h>

namespace batten {

Clspia::Clspia(const NormalSystem& system, Constraints constraints, ClspiaSettings settings)
    : system_(system),
      constraints_(std::move(constraints)),
      settings_(settings),
      multipliers_(constraints_.size(), system.dim()) {
    multipliers_.fill(1); // lambda^0 of ones, section 3.2
}

void Clspia::start(const PointSet&) {
    const ExtremeEigenvalues gamma = extreme_eigenvalues(system_, settings_.eigenvalue_tolerance);
    if (settings_.mu_1 == 0) settings_.mu_1 = (gamma.smallest + gamma.largest) / 2;
    if (!(settings_.mu_1 > gamma.largest / 2))
        throw InvalidInput(
            fmt::format("clspia: mu_1 = {} is outside the convergence region mu_1 > {}",
                        settings_.mu_1, gamma.largest / 2));
    if (constraints_.empty()) return;
    std::unique_ptr<Factorization> normal;
    try {
        normal = factorize(system_);
    } catch (const SolverError&) {
        throw InvalidInput("clspia: the samples that are not interpolated do not determine every "
                           "control point; use --method direct");
    }
    const ExtremeEigenvalues beta =
        SchurComplement(*normal, constraints_, system_.size()).eigenvalues();
    if (settings_.mu == 0) settings_.mu = 2 / (beta.smallest + beta.largest);
    if (!(settings_.mu > 0 && settings_.mu < 2 / beta.largest))
        throw InvalidInput(
            fmt::format("clspia: mu = {} is outside the convergence region 0 < mu < {}",
                        settings_.mu, 2 / beta.largest));
}

const PointSet& Clspia::propose(const PointSet& control) {
    gap_ = constraints_.apply(control);
    add_scaled(gap_, -1.0, constraints_.values());
    if (inner_done_) { // eq. 10, at the last control points of the inner loop
        add_scaled(multipliers_, settings_.mu, gap_);
        inner_done_ = false;
        ++outer_;
    }
    moves_ = system_.gradient(control);
    add_scaled(moves_, -1.0, constraints_.apply_transposed(multipliers_, system_.size()));
    error_ = inner_product(gap_, gap_);
    norm_ = std::sqrt(inner_product(moves_, moves_) + error_);
    for (double& x : moves_.values()) x /= settings_.mu_1; // eq. 8
    return moves_;
}

void Clspia::accept(const PointSet& moves) {
    ++inner_;
    const double enough =
        settings_.inner_tolerance > 0 ? settings_.inner_tolerance : 1e-2 * largest_length(gap_);
    inner_done_ = largest_length(moves) <= enough;
}

Settings Clspia::settings() const {
    return {{"mu", settings_.mu},
            {"mu_1", settings_.mu_1},
            {"inner_iterations", static_cast<double>(inner_)},
            {"outer_iterations", static_cast<double>(outer_)}};
}

} // namespace batten
