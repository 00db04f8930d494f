#pragma once

#include <batten/iterate/method.hpp>
#include <batten/iterate/preconditioner.hpp>

#include <optional>

namespace batten {

/// Preconditioned LSPIA, P <- P + mu M^{-1} A^T D (Q - A P): of sequences and full grids M is made
/// of the middle of every axis's band, diagonally compensated [LiuLiu2020] (there of PIA's
/// collocation matrix); of clouds and weighted grids it is the Kronecker product of the axes' own
/// matrices, or, where the samples leave directions ill-determined, the row sums.
class Plspia : public Method {
  public:
    /// `band`: diagonals kept on either side of the middle, 0 or more: 0 is lin2018, the degree the
    /// direct solution. Without `relaxation`, the factor mu of every step, the best one, 2 /
    /// (largest + smallest eigenvalue of M^{-1} A^T D A), from eigenvalues of that relative
    /// accuracy.
    explicit Plspia(const NormalSystem& system, int band = 1, std::optional<double> relaxation = {},
                    double eigenvalue_tolerance = default_eigenvalue_tolerance);

    std::string_view name() const override { return "plspia"; }
    /// Throws InvalidInput unless 0 < relaxation < 2 / largest eigenvalue.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    double gradient_norm() const override { return norm_; }
    Settings settings() const override;
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return note_; }

  private:
    const NormalSystem& system_;
    int band_;
    std::optional<double> given_factor_;
    double eigenvalue_tolerance_;
    Preconditioning preconditioning_; ///< M^{-1}
    double factor_ = 0;
    double rate_ = 0;
    std::string note_;
    double norm_ = 0;
    PointSet moves_;
};

} // namespace batten
