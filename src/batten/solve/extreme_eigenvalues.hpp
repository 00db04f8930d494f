#pragma once

#include <batten/system/normal_system.hpp>

#include <functional>

namespace batten {

/// The largest and the smallest non-zero eigenvalue of a symmetric positive semidefinite matrix.
struct ExtremeEigenvalues {
    double largest = 0;
    double smallest = 0;
    Index products = 0; ///< with the matrix, or solves, that they took; with any axis's counts one
};

/// y = M x for vectors of the matrix's size.
using VectorOperator = std::function<void(const std::vector<double>& x, std::vector<double>& y)>;

/// x -> A^T D A x, for a system that outlives it.
VectorOperator operator_of(const NormalSystem& system);

/// Which ends of the spectrum must be settled before the iteration may end.
enum class SpectrumEnds { both, largest };

/// Extreme eigenvalues to a relative error of about `tolerance` by the Lanczos method with full
/// reorthogonalisation, from a fixed start in the matrix's range (so zero eigenvalues are not
/// seen). With `preconditioner`, y = M^{-1} x of a symmetric positive definite M, those of M^{-1}
/// times the matrix.
ExtremeEigenvalues lanczos(const VectorOperator& matrix, Index size, double tolerance,
                           SpectrumEnds ends = SpectrumEnds::both,
                           const VectorOperator& preconditioner = {});

/// Those of a banded matrix, sharpened where `tolerance` is small.
ExtremeEigenvalues extreme_eigenvalues(const BandedMatrix& matrix, double tolerance);

/// Those of diag(c) A^T D A diag(c) for the numbers c of a system without factors: the smallest by
/// its inverse, where that is cheaper and there is one.
ExtremeEigenvalues scaled_eigenvalues(const NormalSystem& system, const std::vector<double>& scale,
                                      double tolerance);

/// Those of A^T D A: of each banded factor, multiplied, where the system has factors.
ExtremeEigenvalues extreme_eigenvalues(const NormalSystem& system, double tolerance = 1e-2);

} // namespace batten
