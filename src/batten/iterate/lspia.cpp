#include <batten/iterate/lspia.hpp>

#include <batten/iterate/methods.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

Lspia::Lspia(const NormalSystem& system, std::optional<double> mu, double eigenvalue_tolerance)
    : system_(system), given_mu_(mu), eigenvalue_tolerance_(eigenvalue_tolerance) {}

void Lspia::start(PointSet&) {
    check_setting("lspia", "eigenvalue_tolerance", eigenvalue_tolerance_);
    const WorkingEigenvalues working = working_eigenvalues(system_, eigenvalue_tolerance_);
    const ExtremeEigenvalues& sigma2 = working.values;
    note_ = working.note;
    mu_ = given_mu_.value_or(2 / (sigma2.largest + sigma2.smallest));
    // the largest eigenvalue is known from below only: near the edge leave the judgement to the
    // iteration
    check_setting("lspia", "mu", mu_, {.low = 0, .high = 2 / sigma2.largest},
                  "its region of convergence");
    rate_ = std::max(std::abs(1 - mu_ * sigma2.smallest), std::abs(1 - mu_ * sigma2.largest));
}

const PointSet& Lspia::propose(const PointSet& control) {
    moves_ = system_.gradient(control);
    norm_ = frobenius_norm(moves_);
    for (double& x : moves_.values()) x *= mu_;
    return moves_;
}

} // namespace batten
