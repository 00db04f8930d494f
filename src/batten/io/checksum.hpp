#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace batten {

/// CRC-64/XZ of bytes (ECMA-182's polynomial, reflected): any change within 64 bits in a row shows.
inline std::uint64_t checksum(std::string_view bytes) {
    static constexpr auto table = [] {
        std::array<std::uint64_t, 256> result{};
        for (std::uint64_t i = 0; i < 256; ++i) {
            result[i] = i;
            for (int bit = 0; bit < 8; ++bit)
                result[i] = result[i] >> 1U ^ ((result[i] & 1U) != 0 ? 0xC96C5795D7870F42U : 0);
        }
        return result;
    }();
    std::uint64_t sum = ~std::uint64_t{0};
    for (const char c : bytes)
        sum = table[(sum ^ static_cast<unsigned char>(c)) & 0xFFU] ^ sum >> 8U;
    return ~sum;
}

} // namespace batten
