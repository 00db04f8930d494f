#include <batten/iterate/lspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

Lspia::Lspia(const NormalSystem& system, std::optional<double> mu, double eigenvalue_tolerance,
             std::optional<RowSums> row_sums)
    : gradient_(system, row_sums.value_or(mu ? RowSums::never : RowSums::where_ill_determined),
                eigenvalue_tolerance),
      given_mu_(mu) {}

void Lspia::start(PointSet&) {
    check_setting("lspia", "eigenvalue_tolerance", gradient_.tolerance());
    gradient_.start();
    setup_products_ = gradient_.setup_products();
    const ExtremeEigenvalues& sigma2 = gradient_.eigenvalues().values;
    mu_ = given_mu_.value_or(gradient_.by_row_sums() ? 1 : 2 / (sigma2.largest + sigma2.smallest));
    // the largest eigenvalue is known from below only: near the edge leave the judgement to the
    // iteration
    check_setting("lspia", "mu", mu_, {.low = 0, .high = 2 / sigma2.largest},
                  "its region of convergence");
    const double smallest = gradient_.eigenvalues().found;
    rate_ = gradient_.eigenvalues().raised()
                ? 0
                : std::max(std::abs(1 - mu_ * smallest), std::abs(1 - mu_ * sigma2.largest));
}

const PointSet& Lspia::propose(const PointSet& control) {
    moves_ = gradient_.at(control);
    scale(moves_.values(), mu_);
    return moves_;
}

} // namespace batten
