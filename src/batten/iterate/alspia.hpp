#pragma once

#include <batten/iterate/step_gradient.hpp>

namespace batten {

/// LSPIA whose step factors are one over the roots of a Chebyshev polynomial over the spectrum, in
/// turn [WuLiu2024]; of a singular system, by one that vanishes at 0.
///
/// With the authors' cycle of 10^4 roots the first hundred steps are one over the largest
/// eigenvalue within 0.03 %, and the last ones overflow; a cycle of 16 is Chebyshev's method in
/// earnest.
class Alspia : public Method {
  public:
    explicit Alspia(const NormalSystem& system, Index cycle = 16,
                    double eigenvalue_tolerance = default_eigenvalue_tolerance,
                    RowSums row_sums = RowSums::where_ill_determined);

    std::string_view name() const override { return "alspia"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override { ++taken_; }
    double gradient_norm() const override { return gradient_.norm(); }
    Settings settings() const override;
    std::string note() const override { return gradient_.note(); }

  private:
    double factor() const;

    StepGradient gradient_;
    Index cycle_;
    double largest_ = 0;
    double smallest_ = 0; ///< 0: singular
    Index taken_ = 0;
    PointSet moves_;
};

} // namespace batten
