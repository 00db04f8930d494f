#pragma once

#include <cstddef>

namespace batten {

/// Signed type of every count and position.
using Index = std::ptrdiff_t;

} // namespace batten
