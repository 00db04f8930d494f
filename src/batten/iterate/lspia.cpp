#include <batten/iterate/lspia.hpp>

#include <batten/solve/extreme_eigenvalues.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

Lspia::Lspia(const NormalSystem& system, double mu, double eigenvalue_tolerance)
    : system_(system), mu_(mu), eigenvalue_tolerance_(eigenvalue_tolerance) {}

void Lspia::start(const PointSet&) {
    const WorkingEigenvalues working = working_eigenvalues(system_, eigenvalue_tolerance_);
    const ExtremeEigenvalues& sigma2 = working.values;
    note_ = working.note;
    if (mu_ == 0) mu_ = 2 / (sigma2.largest + sigma2.smallest);
    // the largest eigenvalue is known from below only: near the edge leave the judgement to the
    // iteration
    if (!(mu_ > 0) || mu_ * sigma2.largest >= 2)
        throw InvalidInput(
            fmt::format("lspia: mu = {} is outside the convergence region 0 < mu < {}", mu_,
                        2 / sigma2.largest));
    rate_ = std::max(std::abs(1 - mu_ * sigma2.smallest), std::abs(1 - mu_ * sigma2.largest));
}

const PointSet& Lspia::propose(const PointSet& control) {
    moves_ = system_.gradient(control);
    norm_ = frobenius_norm(moves_);
    for (double& x : moves_.values()) x *= mu_;
    return moves_;
}

} // namespace batten
