#pragma once

#include <batten/core/vectors.hpp>
#include <batten/shape/polygon.hpp>

#include <array>
#include <vector>

namespace batten {

/// Turns of a control polygon at its vertices, over the seam when closed.
struct Turns {
    const PointSet& polygon;
    bool closed;

    Index count() const { return closed ? polygon.size() : polygon.size() - 2; }
    std::array<Index, 3> vertices(Index k) const {
        const Index n = polygon.size();
        return {k % n, (k + 1) % n, (k + 2) % n};
    }
    double value(Index k) const {
        const auto [a, b, c] = vertices(k);
        return turn(polygon[a], polygon[b], polygon[c]);
    }
    /// Sum of the two legs' lengths.
    double legs(Index k) const {
        const auto [a, b, c] = vertices(k);
        return distance(polygon[a], polygon[b]) + distance(polygon[b], polygon[c]);
    }
};

/// Signs with at most `most` changes (over the seam, too, when closed) that have to undo least: by
/// a table of all numbers of changes, or where that would be large by a price for each change, at
/// which no other signs undo less with as many changes.
std::vector<int> nearest_signs(const Turns& turns, Index most);

} // namespace batten
