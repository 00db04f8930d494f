#pragma once

#include <batten/iterate/step_gradient.hpp>
#include <batten/solve/schur.hpp>
#include <batten/system/constraints.hpp>
#include <batten/system/normal_system.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace batten {

/// The numbers of CLSPIA; an absent one is chosen.
struct ClspiaSettings {
    /// Outer step, in (0, 2 / beta_max), beta of S = C (A^T A)^{-1} C^T; else S^{-1}.
    std::optional<double> mu{};
    /// The inner step is 1 / mu_1, mu_1 above gamma_max / 2, gamma of A^T A; else (gamma_min +
    /// gamma_max) / 2, gamma of diag(1/s) A^T A for the row sums s [LinCaoZhang2018].
    std::optional<double> mu_1{};
    /// Whether inner steps are over row sums; else where neither factor is stated.
    std::optional<RowSums> row_sums{};
    /// The inner loop ends when max |Delta| is at most this; else after two steps, where a step
    /// factor is stated at a hundredth of the largest constraint error at hand.
    std::optional<double> inner_tolerance{};
    double eigenvalue_tolerance = default_eigenvalue_tolerance;
    /// Every component of the multipliers' start lambda^0.
    double lambda = 0;
    /// LSPIA steps before the first iteration.
    Index warm_start = 0;
    /// A derivative holds when it lacks at most this part of its length.
    double part_of_derivative = 1e-9;
};

/// Constrained LSPIA [ChangMaDeng2023, eq. 8 to 10 and Algorithm 2]: LSPIA steps on A^T A P = A^T Q
/// - C^T lambda until they are short, then lambda moves by mu times what the constraints lack
/// (Uzawa). With S^{-1} for mu the constraints are taken in the combination that makes every beta
/// 1: however they lie, the rate is that of the inner steps, of which any even number at 2 /
/// (gamma_min + gamma_max) will do [BramblePasciakVassilev1997].
class Clspia : public Method {
  public:
    /// `system` without the interpolated samples; `constraints` relative to its centre,
    /// independent; positions hold when none lacks more than `exactness` (a length).
    /// Throws InvalidInput when `exactness` is negative or not finite.
    Clspia(const NormalSystem& system, Constraints constraints, double exactness,
           ClspiaSettings settings = {});

    std::string_view name() const override { return "clspia"; }
    /// Throws InvalidInput when a step factor is outside its region of convergence or the
    /// approximated samples alone do not determine the control points.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    /// Length of (A^T(Q - AP) - C^T lambda, C P - d).
    double gradient_norm() const override { return norm_; }
    /// That of (A^T(Q - AP), C P - d) at P^0: how long the pull of lambda^0 is says nothing of the
    /// data.
    double reference_norm() const override { return reference_; }
    Settings settings() const override;
    std::string note() const override;
    double constraint_error() const override { return error_; }
    bool constraints_hold() const override;

  private:
    void choose_inner_step();
    void choose_outer_step();
    bool move_multipliers();
    PointSet gap(const PointSet& control) const;
    bool enough(double largest_move) const;

    const NormalSystem& system_;
    StepGradient steps_; ///< of the inner loop
    Constraints constraints_;
    double exactness_;
    ClspiaSettings given_;
    std::unique_ptr<Factorization> normal_;
    std::unique_ptr<SchurComplement> schur_; ///< S
    double beta_max_ = 0;
    double gamma_max_ = 0;
    double mu_1_ = 0;
    PointSet multipliers_;
    PointSet moves_;
    PointSet gap_; // C P - d
    double reference_ = 0;
    double largest_gap_ = 0;
    double norm_ = 0;
    double error_ = 0;
    Index inner_ = 0;
    Index outer_ = 1;
    Index inner_before_ = 0; ///< when the inner loop began
    bool inner_done_ = false;
    std::vector<bool> cut_off_{};     ///< constraints that the moves made did little for
    std::vector<double> least_gap_{}; ///< lengths so far, when multipliers could move
    std::vector<int> idle_{};         ///< how often none was less since
};

} // namespace batten
