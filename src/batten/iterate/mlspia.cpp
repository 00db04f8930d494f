#include <batten/iterate/mlspia.hpp>

#include <batten/solve/extreme_eigenvalues.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>

namespace batten {

namespace {

void complete(MlspiaWeights& w, const ExtremeEigenvalues& sigma2) {
    const double s1 = std::sqrt(sigma2.largest);
    const double sr = std::sqrt(sigma2.smallest);
    const double best = 4 * s1 * sr / ((s1 + sr) * (s1 + sr));
    if (w.omega == 0) w.omega = best;
    if (w.gamma == 0) w.gamma = best;
    if (w.nu == 0) w.nu = 1 / (s1 * sr);
}

/// Equation 11.
void check_region(const MlspiaWeights& w, double sigma2) {
    if (!(w.omega > 0 && w.omega < 2))
        throw InvalidInput(fmt::format(
            "mlspia: omega = {} is outside the convergence region 0 < omega < 2", w.omega));
    if (!(w.nu > 0))
        throw InvalidInput(
            fmt::format("mlspia: nu = {} is outside the convergence region nu > 0", w.nu));
    const double low = w.omega - w.omega / (sigma2 * w.nu);
    const double high = w.omega / 2 - (w.omega - 2) / (sigma2 * w.nu);
    if (!(w.gamma > low && w.gamma < high))
        throw InvalidInput(fmt::format("mlspia: gamma = {} is outside the convergence region "
                                       "{:.6g} < gamma < {:.6g} for omega = {}, nu = {}",
                                       w.gamma, low, high, w.omega, w.nu));
}

/// Largest modulus of the roots of eq. 16 at one singular value.
double root_modulus(const MlspiaWeights& w, double sigma2) {
    const double b = w.gamma * w.nu * sigma2 - (2 - w.omega);
    const double c = sigma2 * w.nu * (w.omega - w.gamma) + 1 - w.omega;
    const std::complex<double> root = std::sqrt(std::complex<double>(b * b - 4 * c));
    return std::max(std::abs((-b + root) / 2.0), std::abs((-b - root) / 2.0));
}

} // namespace

Mlspia::Mlspia(const NormalSystem& system, MlspiaWeights weights, double eigenvalue_tolerance)
    : system_(system), weights_(weights), eigenvalue_tolerance_(eigenvalue_tolerance) {}

void Mlspia::start(const PointSet& control) {
    const WorkingEigenvalues working = working_eigenvalues(system_, eigenvalue_tolerance_);
    const ExtremeEigenvalues& sigma2 = working.values;
    note_ = working.note;
    complete(weights_, sigma2);
    check_region(weights_, sigma2.largest);
    // Lemma 3: 1 - omega and the roots of eq. 16; their modulus is largest at one of the extreme
    // singular values
    rate_ = std::max({std::abs(1 - weights_.omega), root_modulus(weights_, sigma2.largest),
                      root_modulus(weights_, sigma2.smallest)});
    if (last_.empty()) return;
    PointSet before = control;
    add_scaled(before, -1.0, last_);
    last_delta_ = system_.gradient(before);
    for (double& x : last_delta_.values()) x *= weights_.nu;
}

const PointSet& Mlspia::propose(const PointSet& control) {
    delta_ = system_.gradient(control);
    norm_ = frobenius_norm(delta_);
    const auto [omega, gamma, nu] = weights_;
    for (double& x : delta_.values()) x *= nu;
    moves_ = delta_;
    if (!last_.empty()) {
        for (std::size_t k = 0; k < moves_.values().size(); ++k)
            moves_.values()[k] = (1 - omega) * last_.values()[k] + gamma * delta_.values()[k] +
                                 (omega - gamma) * last_delta_.values()[k];
    } else if (!first_.empty()) {
        moves_ = first_;
        for (double& x : moves_.values()) x *= nu;
    } else {
        for (double& x : moves_.values()) x *= omega;
    }
    return moves_;
}

void Mlspia::accept(const PointSet& moves) {
    last_ = moves;
    last_delta_ = delta_;
}

Settings Mlspia::settings() const {
    return {{"omega", weights_.omega}, {"gamma", weights_.gamma}, {"nu", weights_.nu}};
}

} // namespace batten
