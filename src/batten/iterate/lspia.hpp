#pragma once

#include <batten/iterate/step_gradient.hpp>

#include <optional>

namespace batten {

/// Least-squares progressive-iterative approximation, Delta = mu A^T (Q - A P) [DengLin2014, eq. 5
/// and 18].
class Lspia : public Method {
  public:
    /// Without `mu` the best one, 2 / (sigma_1^2 + sigma_r^2), from eigenvalues of that relative
    /// accuracy; of gradients over row sums 1, as lin2018 has it. A stated `mu` multiplies
    /// gradients as they are unless row sums are asked for.
    explicit Lspia(const NormalSystem& system, std::optional<double> mu = {},
                   double eigenvalue_tolerance = default_eigenvalue_tolerance,
                   std::optional<RowSums> row_sums = {});

    std::string_view name() const override { return "lspia"; }
    /// Throws InvalidInput unless 0 < mu < 2 / sigma_1^2, over row sums the largest eigenvalue's.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    double gradient_norm() const override { return gradient_.norm(); }
    Settings settings() const override { return {{"mu", mu_}}; }
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return gradient_.note(); }

  private:
    StepGradient gradient_;
    std::optional<double> given_mu_;
    double mu_ = 0;
    double rate_ = 0;
    PointSet moves_;
};

} // namespace batten
