#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// Interpolates every sample by progressive-iterative approximation. Where nothing is said of the
/// space: cubic, knots from accumulated chords [LinWangDong2004, eq. 1; grids eq. 12 and 13: chords
/// averaged over the rows] and doubled end control points [eq. 2; grids eq. 14]. Else as many
/// control points as samples, or any knots whose collocation matrix is square. Throws InvalidInput
/// when it is not square, or singular.
Fitted fit_pia(const Problem& problem, std::string_view method);

} // namespace batten
