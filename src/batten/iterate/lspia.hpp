#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

#include <optional>

namespace batten {

/// Least-squares progressive-iterative approximation, Delta = mu A^T (Q - A P) [DengLin2014, eq. 5
/// and 18].
class Lspia : public Method {
  public:
    /// Without `mu` the best one, 2 / (sigma_1^2 + sigma_r^2), from eigenvalues of that relative
    /// accuracy; where the samples leave directions ill-determined a step of each control point's
    /// own, as lin2018 takes it.
    explicit Lspia(const NormalSystem& system, std::optional<double> mu = {},
                   double eigenvalue_tolerance = default_eigenvalue_tolerance);

    std::string_view name() const override { return "lspia"; }
    /// Throws InvalidInput unless 0 < mu < 2 / sigma_1^2.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    double gradient_norm() const override { return norm_; }
    Settings settings() const override;
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return note_; }

  private:
    const NormalSystem& system_;
    std::optional<double> given_mu_;
    double mu_ = 0;
    std::vector<double> own_steps_; ///< in place of mu
    double eigenvalue_tolerance_;
    double rate_ = 0;
    std::string note_;
    double norm_ = 0;
    PointSet moves_;
};

} // namespace batten
