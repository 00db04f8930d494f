#pragma once

#include <batten/core/core.hpp>
#include <batten/core/lanes.hpp>

namespace batten {

/// Samples of one knot span on the way into its moments.
struct SpanSamples {
    const double* parameter; ///< (count)
    const double* point;     ///< (count x dim)
    const double* weight;    ///< (count), or null
    Index count;
    Index dim;
};

/// Sums over the samples, per lane: moments[k] of w T_k(s), k = 0 to 2 degree; values[k * dim + d]
/// of w T_k(s) (q_d - centre_d), k = 0 to degree; energy of w |q - centre|^2. s = (t - middle) *
/// scale. Adds to what is there.
void add_span_moments(const SpanSamples& samples, int degree, double middle, double scale,
                      const double* centre, Lanes* moments, Lanes* values, Lanes* energy);

/// The same over a cell of two axes, parameters given as planes: moments[a * (2 q + 1) + b] of
/// T_a(s) T_b(t), values[(a * (q + 1) + b) * dim + d]. `points` are planes too: coordinate d of
/// sample j at points[d * stride + j], already relative to the centre; weights are a plane of ones
/// where there are none.
struct CellSamples {
    const double* s;
    const double* t;
    const double* weight;
    const double* points;
    Index stride;
    Index count;
    Index dim;
};

void add_cell_moments(const CellSamples& samples, int p, int q, Lanes* moments, Lanes* values);

} // namespace batten
