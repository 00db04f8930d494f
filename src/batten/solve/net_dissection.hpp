#pragma once

#include <batten/spline/spline.hpp>

#include <vector>

namespace batten {

/// A net of control points in the order of nested dissection [George1973]: slabs as wide as the
/// degree part it into halves that do not couple, these into quarters, and so on; what is parted
/// comes before what parts it.
struct NetDissection {
    /// Control points that are eliminated together.
    struct Part {
        Index first = 0; ///< place in the order of the first of them
        Index count = 0;
        std::vector<Index> border{}; ///< places after them that they and all that they part couple
                                     ///< with, ascending
        std::vector<Index> children{};
        std::vector<Index> in_parent{}; ///< for each of the border its row there: among the
                                        ///< parent's own, or after these in its border
    };
    /// Parts [begin, end), each after its children.
    struct Run {
        Index begin;
        Index end;
    };
    std::vector<Part> parts;              ///< children before their parents
    std::vector<std::vector<Run>> levels; ///< runs that do not wait for each other, lowest first
    std::vector<Index> place;             ///< of each control point in the order
};

/// Control points couple with those up to the degree away along each axis.
NetDissection dissected(const std::vector<KnotVector>& axes);

} // namespace batten
