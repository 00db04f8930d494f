#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Interpolates every sample by progressive-iterative approximation. Without stated knots or size:
/// cubic, knots from accumulated chords [LinWangDong2004, eq. 1; grids eq. 12 and 13: chords
/// averaged over the rows] and doubled end control points [eq. 2; grids eq. 14]. With them: any
/// knots whose collocation matrix is square. Throws InvalidInput when it is not square, or
/// singular.
FitResult fit_pia(const Samples& samples, const FitOptions& options);

} // namespace batten
