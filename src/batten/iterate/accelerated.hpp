#pragma once

#include <batten/iterate/nonmonotone_search.hpp>
#include <batten/iterate/step_gradient.hpp>

namespace batten {

/// LSPIA whose steps follow the Chebyshev polynomials of the interval [sigma_r^2, sigma_1^2]
/// [GolubVarga1961].
class Chebyshev : public Method {
  public:
    explicit Chebyshev(const NormalSystem& system,
                       double eigenvalue_tolerance = default_eigenvalue_tolerance,
                       RowSums row_sums = RowSums::where_ill_determined);
    std::string_view name() const override { return "chebyshev"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override { last_ = moves; }
    double gradient_norm() const override { return gradient_.norm(); }
    Settings settings() const override {
        return {{"largest", centre_ + radius_}, {"smallest", centre_ - radius_}};
    }
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return gradient_.note(); }

  private:
    StepGradient gradient_;
    double centre_ = 0; // of the eigenvalues' interval
    double radius_ = 0;
    double rho_ = 0; // ratio of consecutive Chebyshev polynomials
    double rate_ = 0;
    PointSet moves_;
    PointSet last_;
};

/// LSPIA with Nesterov's momentum for strongly convex functions [Nesterov2004, section 2.2];
/// NmLSPIA [LiuWuLiHu2024] is the same iteration.
class Nesterov : public Method {
  public:
    explicit Nesterov(const NormalSystem& system,
                      double eigenvalue_tolerance = default_eigenvalue_tolerance,
                      std::string_view name = "nesterov",
                      RowSums row_sums = RowSums::where_ill_determined);
    std::string_view name() const override { return name_; }
    void start(PointSet& control) override;
    void resume(PointSet last_moves) override { last_ = std::move(last_moves); }
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override { last_ = moves; }
    double gradient_norm() const override { return gradient_.norm(); }
    Settings settings() const override { return {{"step", step_}, {"momentum", momentum_}}; }
    std::string note() const override { return gradient_.note(); }

  private:
    StepGradient gradient_;
    std::string_view name_;
    double step_ = 0;
    double momentum_ = 0;
    PointSet moves_;
    PointSet last_;
};

/// LSPIA with Barzilai-Borwein steps [BarzilaiBorwein1988] and the non-monotone search of
/// [GrippoLamparielloLucidi1986] over the last `memory` values. Needs no eigenvalues.
class BarzilaiBorwein : public Method {
  public:
    explicit BarzilaiBorwein(const NormalSystem& system, int memory = 10);
    std::string_view name() const override { return "barzilai-borwein"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    double gradient_norm() const override { return norm_; }
    Settings settings() const override {
        return {{"memory", static_cast<double>(search_.memory())}};
    }

  private:
    const NormalSystem& system_;
    NonmonotoneSearch search_;
    double step_ = 0; // of the next move
    double norm_ = 0;
    PointSet gradient_;
    PointSet image_; // A^T D A gradient
    PointSet moves_;
    PointSet moves_image_;
};

} // namespace batten
