#include <batten/iterate/lspia.hpp>

#include <batten/iterate/lin2018.hpp>
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
    own_steps_.clear();
    if (working.ill_determined && !given_mu_) {
        own_steps_ = diagonal_steps(system_);
        note_ += note_.empty() ? "ill-determined" : "";
        note_ += "; each control point takes the step of Lin, Cao, Zhang 2018 in place of mu";
        rate_ = 0;
        return;
    }
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
    for (Index i = 0; i < moves_.size(); ++i) {
        const double step = own_steps_.empty() ? mu_ : own_steps_[static_cast<std::size_t>(i)];
        for (double& x : moves_[i]) x *= step;
    }
    return moves_;
}

Settings Lspia::settings() const {
    if (own_steps_.empty()) return {{"mu", mu_}};
    return {};
}

} // namespace batten
