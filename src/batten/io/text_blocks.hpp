#pragma once

#include <batten/core/core.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace batten {

/// Appends the texts that `write(i, buffer)` appends for i = 0 to count - 1, in order, written by
/// all threads.
template <class Write>
void append_text(std::string& text, Index count, const Write& write) {
    constexpr Index block_size = 4096;
    constexpr Index together = 64; // blocks that wait for each other: they need memory
    std::vector<fmt::memory_buffer> parts(static_cast<std::size_t>(together));
    for (Index begin = 0; begin < count; begin += together * block_size) {
        const Index end = std::min(count, begin + together * block_size);
        for (fmt::memory_buffer& part : parts) part.clear();
        for_each_block(end - begin, block_size, [&](const Block& block) {
            fmt::memory_buffer& part = parts[static_cast<std::size_t>(block.index)];
            for (Index i = block.begin; i < block.end; ++i) write(begin + i, part);
        });
        for (const fmt::memory_buffer& part : parts) text.append(part.data(), part.size());
    }
}

} // namespace batten
