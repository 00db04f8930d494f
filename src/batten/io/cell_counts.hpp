#pragma once

#include <batten/spline/spline.hpp>

#include <vector>

namespace batten {

/// Cells of each knot span, per axis.
using CellCounts = std::vector<std::vector<Index>>;

/// Equal parts of every span, few of them, so that interpolation is within `chord` of the spline:
/// between neighbouring points of a curve, in both triangles of a surface's cells by either
/// diagonal [FilipMagedsonMarkot1986], in a volume's trilinear cells. Certain: second derivatives
/// are bounded by the second differences of each piece's Bezier points. At most 10^9 in a span.
CellCounts least_cells(const Spline& spline, double chord);

} // namespace batten
