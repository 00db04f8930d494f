#pragma once

#include <batten/iterate/method.hpp>
#include <batten/solve/working_eigenvalues.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// Whether each control point's part of the gradient is taken over its row sum of |A^T D A|.
enum class RowSums { where_ill_determined, never, always };

/// The gradient that step factors multiply, and the eigenvalues that they are chosen by: those of
/// H = A^T D A, or those of diag(1/s) H for the row sums s of |H|, at most 1 [LinCaoZhang2018].
class StepGradient {
  public:
    StepGradient(const NormalSystem& system, RowSums row_sums, double eigenvalue_tolerance)
        : system_(system), row_sums_(row_sums), tolerance_(eigenvalue_tolerance) {}

    /// Finds the eigenvalues; once, before anything else.
    void start();

    /// A^T D (Q - A P), or diag(1/s) times it; control points that no sample reaches have none.
    PointSet at(const PointSet& control);
    /// H times moves, or diag(1/s) H.
    PointSet image(const PointSet& moves) const;
    /// Divides each row by its s, or nothing.
    void scale(PointSet& rows) const;

    /// Frobenius norm of A^T D (Q - A P) at the last `at`, before it was scaled.
    double norm() const { return norm_; }
    bool by_row_sums() const { return !over_sums_.empty(); }
    const WorkingEigenvalues& eigenvalues() const { return working_; }
    /// With H, or solves, that the eigenvalues took.
    Index setup_products() const { return products_; }
    double tolerance() const { return tolerance_; }
    const std::string& note() const { return working_.note; }

  private:
    const NormalSystem& system_;
    RowSums row_sums_;
    double tolerance_;
    std::vector<double> over_sums_; ///< 1/s; empty: not taken
    WorkingEigenvalues working_;
    Index products_ = 0;
    double norm_ = 0;
};

} // namespace batten
