#include <batten/iterate/mlspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

/// The sigma_1^2 nu below which gamma is inside the region of eq. 11.
double longest_step(double omega, double gamma) {
    double longest = std::numeric_limits<double>::infinity();
    if (gamma < omega) longest = omega / (omega - gamma);
    if (gamma > omega / 2) longest = std::min(longest, (2 - omega) / (gamma - omega / 2));
    return longest;
}

} // namespace

Mlspia::Mlspia(const NormalSystem& system, MlspiaWeights weights, double eigenvalue_tolerance,
               std::optional<RowSums> row_sums, std::string_view name)
    : gradient_(
          system,
          row_sums.value_or(weights.stated() ? RowSums::never : RowSums::where_ill_determined),
          eigenvalue_tolerance),
      given_(weights),
      name_(name) {}

void Mlspia::choose_weights(const ExtremeEigenvalues& sigma2) {
    const double s1 = std::sqrt(sigma2.largest);
    const double sr = std::sqrt(sigma2.smallest);
    const double best = 4 * s1 * sr / ((s1 + sr) * (s1 + sr));
    omega_ = given_.omega.value_or(best);
    gamma_ = given_.gamma.value_or(best);
    check_setting("mlspia", "omega", omega_);
    // the best nu suits the best gamma; another gamma may want a shorter step
    const double longest = longest_step(omega_, gamma_);
    nu_ = given_.nu.value_or(s1 < longest * sr ? 1 / (s1 * sr) : longest / 2 / sigma2.largest);
    check_setting("mlspia", "nu", nu_);
    if (given_.nu && !given_.gamma) { // eq. 11 for the one of the two that the caller chose
        check_setting("mlspia", "nu", nu_, {.low = 0, .high = longest / sigma2.largest},
                      fmt::format("its region of convergence for omega = {:.6g}, gamma = {:.6g}",
                                  omega_, gamma_));
        return;
    }
    const double step = sigma2.largest * nu_;
    check_setting(
        "mlspia", "gamma", gamma_,
        {.low = omega_ - omega_ / step, .high = omega_ / 2 - (omega_ - 2) / step},
        fmt::format("its region of convergence for omega = {:.6g}, nu = {:.6g}", omega_, nu_));
}

/// Largest modulus of the roots of eq. 16 at one singular value.
double Mlspia::root_modulus(double sigma2) const {
    const double b = gamma_ * nu_ * sigma2 - (2 - omega_);
    const double c = sigma2 * nu_ * (omega_ - gamma_) + 1 - omega_;
    const std::complex<double> root = std::sqrt(std::complex<double>(b * b - 4 * c));
    return std::max(std::abs((-b + root) / 2.0), std::abs((-b - root) / 2.0));
}

void Mlspia::start(PointSet& control) {
    check_setting("mlspia", "eigenvalue_tolerance", gradient_.tolerance());
    gradient_.start();
    const WorkingEigenvalues& working = gradient_.eigenvalues();
    ExtremeEigenvalues sigma2 = working.values;
    // the best weights leave eq. 11 this part of the largest as room, and it is known from below
    if (gradient_.tolerance() > sigma2.smallest / sigma2.largest)
        sigma2.largest *= 1 + gradient_.tolerance();
    setup_products_ = gradient_.setup_products();
    choose_weights(sigma2);
    // Lemma 3: 1 - omega and the roots of eq. 16; their modulus is largest at one of the extreme
    // singular values
    rate_ = working.raised() ? 0
                             : std::max({std::abs(1 - omega_), root_modulus(sigma2.largest),
                                         root_modulus(sigma2.smallest)});
    if (last_.empty()) return;
    PointSet before = control;
    add_scaled(before, -1.0, last_);
    last_delta_ = gradient_.at(before);
    scale(last_delta_.values(), nu_);
}

const PointSet& Mlspia::propose(const PointSet& control) {
    delta_ = gradient_.at(control);
    scale(delta_.values(), nu_);
    moves_ = delta_;
    if (!last_.empty()) {
        for (std::size_t k = 0; k < moves_.values().size(); ++k)
            moves_.values()[k] = (1 - omega_) * last_.values()[k] + gamma_ * delta_.values()[k] +
                                 (omega_ - gamma_) * last_delta_.values()[k];
    } else if (!first_.empty()) {
        moves_ = first_;
        gradient_.scale(moves_);
        scale(moves_.values(), nu_);
    } else {
        scale(moves_.values(), given_.lambda.value_or(omega_));
    }
    return moves_;
}

void Mlspia::accept(const PointSet& moves) {
    last_ = moves;
    last_delta_ = delta_;
}

Settings Mlspia::settings() const {
    return {{"omega", omega_}, {"gamma", gamma_}, {"nu", nu_}};
}

} // namespace batten
