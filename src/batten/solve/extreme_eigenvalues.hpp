#pragma once

#include <batten/system/normal_system.hpp>

#include <functional>
#include <string>

namespace batten {

/// The largest and the smallest non-zero eigenvalue of a symmetric positive semidefinite matrix.
struct ExtremeEigenvalues {
    double largest = 0;
    double smallest = 0;
};

/// y = M x for vectors of the matrix's size.
using VectorOperator = std::function<void(const std::vector<double>& x, std::vector<double>& y)>;

/// Which ends of the spectrum must be settled before the iteration may end.
enum class SpectrumEnds { both, largest };

/// Extreme eigenvalues to a relative error of about `tolerance` by the Lanczos method with full
/// reorthogonalisation, from a fixed start in the matrix's range (so zero eigenvalues are not
/// seen).
ExtremeEigenvalues lanczos(const VectorOperator& matrix, Index size, double tolerance,
                           SpectrumEnds ends = SpectrumEnds::both);

/// Those of A^T D A: of each banded factor, multiplied, where the system has factors.
ExtremeEigenvalues extreme_eigenvalues(const NormalSystem& system, double tolerance = 1e-2);

/// Eigenvalues to choose step factors by.
struct WorkingEigenvalues {
    ExtremeEigenvalues values;
    std::string note;            ///< says so when directions are ill-determined
    bool ill_determined = false; ///< the note is there, or the smallest below 1e-6 of the largest
};

/// The extreme eigenvalues, but when the smallest is below 1e-7 of the largest, 1e-6 of the largest
/// in its place: directions that the samples hardly determine would slow all others to their own
/// pace. The note names them.
WorkingEigenvalues working_eigenvalues(const NormalSystem& system, double tolerance);

} // namespace batten
