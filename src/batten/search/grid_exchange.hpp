#pragma once

#include <batten/search/grid_sizes.hpp>

namespace batten {

/// fewest_sizes() by some of very many samples, checked by all: those that break the tolerance join
/// the others until none does, as cuts do in [Kelley1960]. What is found is fitted to all samples
/// once more where that keeps the tolerance. Where there are not so many samples, something must
/// hold exactly, or a third of them does not suffice, it is that search itself.
GridWithin sizes_by_exchange(const GridTask& task);

} // namespace batten
