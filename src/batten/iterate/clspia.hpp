#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/constraints.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// Constrained LSPIA [ChangMaDeng2023, eq. 8 to 10 and Algorithm 2]: LSPIA steps on A^T A P = A^T Q
/// - C^T lambda until they are short, then lambda moves by mu times what the constraints lack
/// (Uzawa).
struct ClspiaSettings {
    double mu = 0; ///< outer step; 0 takes 2 / (beta_min + beta_max), beta of C (A^T A)^{-1} C^T
    double mu_1 =
        0; ///< the inner step is 1 / mu_1; 0 takes (gamma_min + gamma_max) / 2, gamma of A^T A
    /// The inner loop ends when max |Delta| is at most this; 0: a hundredth of the largest
    /// constraint error at hand, so that it tightens as the outer loop converges.
    double inner_tolerance = 0;
    double eigenvalue_tolerance = 1e-2;
};

class Clspia : public Method {
  public:
    /// `system` without the interpolated samples; `constraints` relative to its centre,
    /// independent.
    Clspia(const NormalSystem& system, Constraints constraints, ClspiaSettings settings = {});

    std::string_view name() const override { return "clspia"; }
    /// Throws InvalidInput when a step factor is outside its region of convergence or the
    /// approximated samples alone do not determine the control points.
    void start(const PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    /// Length of (A^T(Q - AP) - C^T lambda, C P - d).
    double gradient_norm() const override { return norm_; }
    Settings settings() const override;
    double constraint_error() const override { return error_; }

  private:
    const NormalSystem& system_;
    Constraints constraints_;
    ClspiaSettings settings_;
    PointSet multipliers_;
    PointSet moves_;
    PointSet gap_; // C P - d
    double norm_ = 0;
    double error_ = 0;
    Index inner_ = 0;
    Index outer_ = 1;
    bool inner_done_ = false;
};

} // namespace batten
