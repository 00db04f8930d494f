#pragma once

#include <batten/solve/factorization.hpp>

namespace batten {

/// An estimate from below, seldom by more than a factor of three, of the 1-norm of the inverse of
/// D^{-1/2} M D^{-1/2} for a factored normal matrix M and its diagonal D [Higham2002, algorithm
/// 15.1]: M's condition, times at most the entries of a row, once the scales of the control points
/// are taken out.
double inverse_norm(const NormalSystem& system, const Factorization& factorization);

} // namespace batten
