#pragma once

#include <batten/system/normal_system.hpp>

#include <vector>

namespace batten {

/// Sums of the absolute values in the rows of A^T D A (N); without roughness each basis function's
/// weighted sum over the samples, for B-splines sum to one. The largest bounds the eigenvalues.
std::vector<double> row_sums(const NormalSystem& system);

/// The same of one banded matrix.
std::vector<double> row_sums(const BandedMatrix& matrix);

} // namespace batten
