#pragma once

#include <batten/basis/knot_vector.hpp>
#include <batten/core/grid_index.hpp>

#include <vector>

namespace batten {

/// Places of half a stencil, those of the control points that one couples with: offsets of 0 to the
/// degree along axis 0, of both signs along the others: (p_0 + 1) x (2 p_1 + 1) x (2 p_2 + 1).
inline GridIndex half_stencil(const std::vector<KnotVector>& axes) {
    std::vector<Index> shape{axes[0].degree() + 1};
    for (std::size_t k = 1; k < axes.size(); ++k) shape.push_back(2 * axes[k].degree() + 1);
    return GridIndex(shape);
}

/// The offset that a place of the half stencil stands for.
inline GridIndex::Place half_stencil_offset(const std::vector<KnotVector>& axes,
                                            GridIndex::Place place) {
    for (std::size_t k = 1; k < axes.size(); ++k) place[k] -= axes[k].degree();
    return place;
}

/// The place that stands for an offset.
inline GridIndex::Place half_stencil_place(const std::vector<KnotVector>& axes,
                                           GridIndex::Place offset) {
    for (std::size_t k = 1; k < axes.size(); ++k) offset[k] += axes[k].degree();
    return offset;
}

} // namespace batten
