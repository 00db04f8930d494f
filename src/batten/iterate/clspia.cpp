#include <batten/iterate/clspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

Clspia::Clspia(const NormalSystem& system, Constraints constraints, double exactness,
               ClspiaSettings settings)
    : system_(system),
      steps_(system,
             settings.row_sums.value_or(settings.mu || settings.mu_1 ? RowSums::never
                                                                     : RowSums::always),
             settings.eigenvalue_tolerance),
      constraints_(constraints.balanced()),
      exactness_(exactness),
      given_(settings),
      multipliers_(constraints_.size(), system.dim()) {
    if (!std::isfinite(exactness) || exactness < 0)
        throw InvalidInput(fmt::format("clspia: exactness {} must be 0 or more", exactness));
}

void Clspia::start(PointSet& control) {
    check_setting("clspia", "eigenvalue_tolerance", given_.eigenvalue_tolerance);
    if (given_.inner_tolerance) check_setting("clspia", "inner_tolerance", *given_.inner_tolerance);
    choose_inner_step();
    if (!constraints_.empty()) choose_outer_step();
    multipliers_.fill(given_.lambda);
    const auto count = static_cast<std::size_t>(constraints_.size());
    cut_off_.assign(count, false);
    least_gap_.assign(count, std::numeric_limits<double>::infinity());
    idle_.assign(count, 0);
    for (Index k = 0; k < given_.warm_start; ++k)
        add_scaled(control, 1 / mu_1_, steps_.at(control));
    reference_ =
        std::hypot(frobenius_norm(system_.gradient(control)), frobenius_norm(gap(control)));
}

void Clspia::choose_inner_step() {
    steps_.start();
    setup_products_ = steps_.setup_products();
    const ExtremeEigenvalues& gamma = steps_.eigenvalues().values;
    gamma_max_ = (1 + given_.eigenvalue_tolerance) * gamma.largest; // it is known from below
    mu_1_ = given_.mu_1.value_or((gamma.smallest + gamma_max_) / 2);
    check_setting("clspia", "mu_1", mu_1_, {.low = gamma.largest / 2}, "its region of convergence");
}

void Clspia::choose_outer_step() {
    try {
        normal_ = factorize(system_);
    } catch (const SolverError&) {
        throw InvalidInput("clspia: the samples that are not interpolated do not determine every "
                           "control point; use method direct");
    }
    schur_ = std::make_unique<SchurComplement>(*normal_, constraints_, system_.size());
    setup_products_ += constraints_.size(); // a solve each
    beta_max_ = schur_->largest_eigenvalue();
    if (given_.mu)
        check_setting("clspia", "mu", *given_.mu, {.low = 0, .high = 2 / beta_max_},
                      "its region of convergence");
}

PointSet Clspia::gap(const PointSet& control) const {
    PointSet result = constraints_.apply(control);
    add_scaled(result, -1.0, constraints_.values());
    return result;
}

bool Clspia::constraints_hold() const {
    for (Index j = 0; j < gap_.size(); ++j) {
        const double length = constraints_.is_position(j) ? 0 : norm(constraints_.values()[j]);
        if (norm(gap_[j]) > (length > 0 ? given_.part_of_derivative * length : exactness_))
            return false;
    }
    return true;
}

const PointSet& Clspia::propose(const PointSet& control) {
    gap_ = gap(control);
    largest_gap_ = largest_length(gap_);
    if (inner_done_ && move_multipliers()) {
        inner_before_ = inner_;
        inner_done_ = false;
        ++outer_;
    }
    moves_ = system_.gradient(control);
    add_scaled(moves_, -1.0, constraints_.apply_transposed(multipliers_, system_.size()));
    error_ = inner_product(gap_, gap_);
    norm_ = std::sqrt(inner_product(moves_, moves_) + error_);
    steps_.scale(moves_);
    for (double& x : moves_.values()) x /= mu_1_; // eq. 8
    return moves_;
}

/// Eq. 10, at the last control points of the inner loop; of a constraint whose moves are cut off
/// only while its gap still becomes less now and then, else the multiplier would wind up. Whether
/// any moved.
bool Clspia::move_multipliers() {
    const PointSet steps = given_.mu ? gap_ : schur_->solve(gap_);
    constexpr int patience = 100;
    bool moved = false;
    for (Index j = 0; j < gap_.size(); ++j) {
        const auto k = static_cast<std::size_t>(j);
        const double length = norm(gap_[j]);
        idle_[k] = length < least_gap_[k] ? 0 : idle_[k] + 1;
        least_gap_[k] = std::min(length, least_gap_[k]);
        if (cut_off_[k] && idle_[k] > patience) continue;
        for (std::size_t d = 0; d < gap_[j].size(); ++d)
            multipliers_[j][d] += given_.mu.value_or(1) * steps[j][d];
        moved = true;
    }
    return moved;
}

bool Clspia::enough(double largest_move) const {
    if (given_.inner_tolerance) return largest_move <= *given_.inner_tolerance;
    if (given_.mu || given_.mu_1) return largest_move <= 1e-2 * largest_gap_;
    return (inner_ - inner_before_) % 2 == 0;
}

void Clspia::accept(const PointSet& moves) {
    ++inner_;
    cut_off_.assign(cut_off_.size(), false);
    if (moves.values() != moves_.values()) { // a shape is kept
        constexpr double most = 0.5;         // of what they would do to the gap
        const PointSet wanted = constraints_.apply(moves_);
        PointSet lost = wanted;
        add_scaled(lost, -1.0, constraints_.apply(moves));
        for (Index j = 0; j < lost.size(); ++j)
            cut_off_[static_cast<std::size_t>(j)] = norm(lost[j]) > most * norm(wanted[j]);
    }
    inner_done_ = !constraints_.empty() && enough(largest_length(moves));
}

std::string Clspia::note() const {
    if (given_.lambda == 0) return {};
    return "lambda: multipliers that start from another number than 0 make the iterations depend "
           "on the unit of the data";
}

Settings Clspia::settings() const {
    Settings result{{"mu_1", mu_1_},
                    {"gamma_max", gamma_max_},
                    {"beta_max", beta_max_},
                    {"inner_iterations", static_cast<double>(inner_)},
                    {"outer_iterations", static_cast<double>(outer_)}};
    if (given_.mu) result["mu"] = *given_.mu;
    return result;
}

} // namespace batten
