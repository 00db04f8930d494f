#include <batten/iterate/plspia.hpp>

#include <batten/iterate/methods.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Those of M^{-1} A^T D A.
ExtremeEigenvalues preconditioned_extremes(const NormalSystem& system,
                                           const Preconditioning& preconditioning,
                                           double tolerance) {
    PointSet image(system.size(), 1);
    const VectorOperator forward = [&](const std::vector<double>& x, std::vector<double>& y) {
        system.apply(PointSet(x, 1), image);
        y = image.values();
    };
    const VectorOperator inverse = [&](const std::vector<double>& x, std::vector<double>& y) {
        PointSet solved(x, 1);
        preconditioning.apply(solved);
        y = solved.values();
    };
    return lanczos(forward, system.size(), tolerance, SpectrumEnds::both, inverse);
}

} // namespace

Plspia::Plspia(const NormalSystem& system, int band, std::optional<double> relaxation,
               double eigenvalue_tolerance)
    : system_(system),
      band_(band),
      given_factor_(relaxation),
      eigenvalue_tolerance_(eigenvalue_tolerance) {}

void Plspia::start(PointSet&) {
    constexpr double ill_determined = 1e-6;
    check_setting("plspia", "band", band_);
    check_setting("plspia", "eigenvalue_tolerance", eigenvalue_tolerance_);
    const bool banded = !system_.factors().empty();
    preconditioning_ = banded ? Preconditioning::compensated_bands(system_, band_)
                              : Preconditioning(system_, Preconditioner::axes);
    ExtremeEigenvalues e =
        preconditioned_extremes(system_, preconditioning_, eigenvalue_tolerance_);
    setup_products_ = e.products;
    if (banded) e.largest = std::max(e.largest, 1.0); // never above it
    // where directions are ill-determined the best step would leave the largest mode where it is
    factor_ = given_factor_.value_or(
        e.smallest > ill_determined * e.largest ? 2 / (e.largest + e.smallest) : 1 / e.largest);
    check_setting("plspia", "relaxation", factor_, {.low = 0, .high = 2 / e.largest},
                  "its region of convergence");
    rate_ = std::max(std::abs(1 - factor_ * e.smallest), std::abs(1 - factor_ * e.largest));
}

const PointSet& Plspia::propose(const PointSet& control) {
    moves_ = system_.gradient(control);
    norm_ = frobenius_norm(moves_);
    preconditioning_.apply(moves_);
    for (double& x : moves_.values()) x *= factor_;
    return moves_;
}

Settings Plspia::settings() const {
    Settings result{{"relaxation", factor_}};
    if (preconditioning_.diagonals() >= 0) result["band"] = preconditioning_.diagonals();
    return result;
}

} // namespace batten
