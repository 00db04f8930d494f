#pragma once

#include <batten/core/core.hpp>

#include <fmt/format.h>
#include <string>
#include <vector>

namespace batten {

/// The texts that `write(i, buffer)` appends for i = 0 to count - 1, in order, written by all
/// threads.
template <class Write>
void append_text(std::string& text, Index count, const Write& write) {
    constexpr Index block_size = 1 << 14;
    std::vector<fmt::memory_buffer> parts(static_cast<std::size_t>(block_count(count, block_size)));
    for_each_block(count, block_size, [&](const Block& block) {
        fmt::memory_buffer& part = parts[static_cast<std::size_t>(block.index)];
        for (Index i = block.begin; i < block.end; ++i) write(i, part);
    });
    std::size_t size = text.size();
    for (const fmt::memory_buffer& part : parts) size += part.size();
    text.reserve(size);
    for (const fmt::memory_buffer& part : parts) text.append(part.data(), part.size());
}

} // namespace batten
