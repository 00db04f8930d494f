#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Discrete curvature |dP x d2P| / |dP|^3 at every point of a sequence without identical
/// neighbours, after smoothing by a Gaussian whose width adapts to the point: up to `widest` points
/// to either side where the sequence is nearly straight, fewer near corners [LinZhang2011, eq. 29,
/// after Ray and Pandyan]. Any dimension; the ends get their neighbours' value.
std::vector<double> discrete_curvature(const Points& sequence, Index widest);

/// Indices of the first, the last and all local maxima between, ascending: the dominant points
/// [LinZhang2011, eq. 31].
std::vector<Index> dominant_indices(const std::vector<double>& curvature);

} // namespace batten
