#pragma once

#include <batten/system/normal_system.hpp>

#include <functional>
#include <string>

namespace batten {

/// The largest and the smallest non-zero eigenvalue of a symmetric positive semidefinite matrix.
struct ExtremeEigenvalues {
    double largest = 0;
    double smallest = 0;
    Index products = 0; ///< with the matrix, or solves, that they took; with any axis's counts one
};

/// y = M x for vectors of the matrix's size.
using VectorOperator = std::function<void(const std::vector<double>& x, std::vector<double>& y)>;

/// Which ends of the spectrum must be settled before the iteration may end.
enum class SpectrumEnds { both, largest };

/// Extreme eigenvalues to a relative error of about `tolerance` by the Lanczos method with full
/// reorthogonalisation, from a fixed start in the matrix's range (so zero eigenvalues are not
/// seen). With `preconditioner`, y = M^{-1} x of a symmetric positive definite M, those of M^{-1}
/// times the matrix.
ExtremeEigenvalues lanczos(const VectorOperator& matrix, Index size, double tolerance,
                           SpectrumEnds ends = SpectrumEnds::both,
                           const VectorOperator& preconditioner = {});

/// Those of A^T D A: of each banded factor, multiplied, where the system has factors.
ExtremeEigenvalues extreme_eigenvalues(const NormalSystem& system, double tolerance = 1e-2);

/// Eigenvalues to choose step factors by.
struct WorkingEigenvalues {
    ExtremeEigenvalues values;
    double found = 0;            ///< the smallest before it was raised; `values.smallest` elsewhere
    std::string note;            ///< says so when directions are ill-determined, or one was raised
    bool ill_determined = false; ///< control points hardly reached, or the smallest below 1e-6

    bool raised() const { return found < values.smallest; }
};

/// The extreme eigenvalues of A^T D A, but when the smallest is below 1e-7 of the largest, 1e-6 of
/// the largest in its place: directions that the samples hardly determine would slow all others to
/// their own pace. The note names them.
WorkingEigenvalues working_eigenvalues(const NormalSystem& system, double tolerance);

/// Those of diag(1/s) A^T D A for the row sums s of |A^T D A| (0 for 1/0), where none is above 1.
/// Without roughness the smallest counts as 1e-3 at least: what lies below is what the samples
/// leave open, and an iteration that waits for it does not come near the data for its square
/// root's number of steps; with roughness it is the data's own.
WorkingEigenvalues row_scaled_eigenvalues(const NormalSystem& system, double tolerance);

} // namespace batten
