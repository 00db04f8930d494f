#pragma once

#include <batten/core/core.hpp>

#include <vector>

namespace batten {

/// Samples of a sequence at which the direction jumps: the turn there is sharp, and much sharper
/// than at its neighbours, seen over one sample and over two. Ascending; never the ends of an open
/// one.
std::vector<Index> find_corners(const Points& sequence, Closure closure = Closure::open);

} // namespace batten
