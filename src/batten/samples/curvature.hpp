#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Discrete curvature |dP x d2P| / |dP|^3 at every point of a sequence without identical
/// neighbours, after smoothing by a Gaussian whose width adapts to the point: up to `widest` points
/// to either side where the sequence is nearly straight, fewer near corners [LinZhang2011, eq. 29,
/// after Ray and Pandyan]. Any dimension; the ends get their neighbours' value.
/// `error`: how far a coordinate may be off; a bend that this makes, or the rounding of the
/// formula, is none.
std::vector<double> discrete_curvature(const Points& sequence, Index widest, double error = 0);

/// Indices of the first, the last and all local maxima between, ascending: the dominant points
/// [LinZhang2011, eq. 31].
std::vector<Index> dominant_indices(const std::vector<double>& curvature);

/// The same of the maxima that stand out: above the minima to both sides by more than `rise`.
std::vector<Index> dominant_indices(const std::vector<double>& curvature, double rise);

/// What as many values of noise as these span, where they are noisy: twice sqrt(2 ln m) standard
/// deviations, these by the values' third differences.
double span_of_noise(const std::vector<double>& values);

} // namespace batten
