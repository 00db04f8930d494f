#pragma once

#include <batten/solve/extreme_eigenvalues.hpp>

#include <string>

namespace batten {

/// The smallest eigenvalue, in parts of the largest, below which samples leave directions open that
/// steps by eigenvalues would all wait for.
inline constexpr double least_determined = 1e-5;

/// Whether the samples more than hardly reach every control point; they may leave directions open
/// still.
bool reaches_all(const NormalSystem& system);

/// Eigenvalues to choose step factors by.
struct WorkingEigenvalues {
    ExtremeEigenvalues values;
    double found = 0;            ///< the smallest before it was raised; `values.smallest` elsewhere
    std::string note;            ///< says so when directions are ill-determined, or one was raised
    bool ill_determined = false; ///< control points hardly reached, or the smallest below that

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
