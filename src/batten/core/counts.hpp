#pragma once

#include <batten/core/index.hpp>

#include <span>
#include <string_view>

namespace batten {

/// The product of counts (1 of none). Throws InvalidInput naming `what` and the counts when one is
/// negative or the product is beyond every Index.
Index checked_product(std::span<const Index> counts, std::string_view what);

/// Throws InvalidInput naming `what` when `doubles` numbers are more than the machine's free memory
/// or the process's limit can hold: to be asked before they are allocated.
void check_memory(Index doubles, std::string_view what);

} // namespace batten
