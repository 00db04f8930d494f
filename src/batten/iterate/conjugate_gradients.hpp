#pragma once

#include <batten/iterate/method.hpp>
#include <batten/iterate/preconditioner.hpp>

namespace batten {

/// Conjugate gradients on the normal equations [HestenesStiefel1952], the baseline of all
/// iterations here. Control points without samples stay where they start.
class ConjugateGradients : public Method {
  public:
    explicit ConjugateGradients(const NormalSystem& system,
                                Preconditioner preconditioner = Preconditioner::diagonal);

    std::string_view name() const override { return "cg"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    double gradient_norm() const override { return norm_; }

  private:
    const NormalSystem& system_;
    Preconditioner preconditioner_;
    Preconditioning preconditioning_;
    PointSet gradient_;  // r
    PointSet direction_; // d
    PointSet image_;     // A^T D A d
    PointSet moves_;
    double energy_ = 0; // <r, M r> of the current direction
    double step_ = 0;
    double norm_ = 0;
    bool fresh_ = true;
};

} // namespace batten
