#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// LSPIA for singular systems, as it is coded beside [PengLi2026] after [LinCaoZhang2018]: every
/// control point moves by its part of A^T D (Q - A P) over its row sum of A^T D A; those without
/// samples stay. The limit is the minimiser nearest to the start in the norm of these sums.
class Lin2018 : public Method {
  public:
    explicit Lin2018(const NormalSystem& system) : system_(system) {}

    std::string_view name() const override { return "lin2018"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    double gradient_norm() const override { return norm_; }

  private:
    const NormalSystem& system_;
    std::vector<double> steps_;
    double norm_ = 0;
    PointSet moves_;
};

/// One over each row sum of A^T D A, 0 where that is rounding: no eigenvalue of the product is
/// above 1.
std::vector<double> diagonal_steps(const NormalSystem& system);

/// A^T D (Q - A P), zero for control points whose step is 0.
PointSet reached_gradient(const NormalSystem& system, const PointSet& control,
                          const std::vector<double>& steps);

/// Multiplies each row by its factor.
void scale_rows(PointSet& rows, const std::vector<double>& factors);

} // namespace batten
