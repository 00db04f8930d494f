#pragma once

#include <atomic>
#include <cstddef>

namespace batten::testing {

/// The largest piece of memory that `new` was asked for since this was zero; under a sanitizer,
/// which has an allocator of its own, always zero.
extern std::atomic<std::size_t> largest_allocation;

} // namespace batten::testing
