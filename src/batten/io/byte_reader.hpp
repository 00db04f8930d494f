#pragma once

#include <batten/core/core.hpp>

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <string_view>

namespace batten {

/// Numbers of either byte order out of a file's content, bounds checked: past the end it throws
/// FileError naming the path, what was wanted and where.
class ByteReader {
  public:
    ByteReader(const std::filesystem::path& path, std::string_view content)
        : path_(path), content_(content) {}

    std::size_t at() const { return at_; }
    std::size_t left() const { return content_.size() - at_; }
    void seek(std::size_t place, std::string_view what) {
        if (place > content_.size()) fail_short(what, place);
        at_ = place;
    }

    template <class Number>
    Number read(std::string_view what, std::endian order = std::endian::little) {
        if (sizeof(Number) > left()) fail_short(what, at_ + sizeof(Number));
        unsigned char bytes[sizeof(Number)];
        for (std::size_t k = 0; k < sizeof(Number); ++k)
            bytes[order == std::endian::native ? k : sizeof(Number) - 1 - k] =
                static_cast<unsigned char>(content_[at_ + k]);
        Number value;
        std::memcpy(&value, bytes, sizeof(Number));
        at_ += sizeof(Number);
        return value;
    }

  private:
    [[noreturn]] void fail_short(std::string_view what, std::size_t wanted) const {
        throw FileError(fmt::format("{}: the file ends at byte {}, {} needs {}", path_.string(),
                                    content_.size(), what, wanted));
    }

    const std::filesystem::path& path_;
    std::string_view content_;
    std::size_t at_ = 0;
};

} // namespace batten
