#pragma once

#include <batten/basis/knot_vector.hpp>
#include <batten/parametrize/parametrize.hpp>
#include <batten/samples/samples.hpp>

namespace batten {

/// How knots are spread over an axis: the accumulated density at the axis's parameters, from 0
/// to 1.
using Spread = std::vector<double>;

/// The parameters along each axis, ascending: a cloud's sorted.
std::vector<std::vector<double>> ascending(const Parameters& parameters);

/// Density from differences of order p + 1 of the samples along the axis: the largest over all
/// rows, smoothed, to the power 1 / (p + 1).
Spread bend_spread(const Samples& samples, const std::vector<double>& t, std::size_t axis,
                   int degree);

/// The same density everywhere.
Spread even_spread(const std::vector<double>& t);

/// Knots for n control points, each span with an equal part of the spread.
KnotVector knots_by(const Spread& spread, const std::vector<double>& t, int degree, Index n,
                    Closure closure);

} // namespace batten
