#pragma once

#include <batten/io/byte_source.hpp>

#include <bit>
#include <cstring>
#include <string>
#include <string_view>

namespace batten {

/// Numbers of either byte order, lines and words of a file of known size, through a buffer. Bounds
/// are checked: past the end it throws FileError naming the path, what was wanted and where.
class BufferedBytes {
  public:
    BufferedBytes(const std::filesystem::path& path, std::unique_ptr<ByteSource> source);

    std::uint64_t size() const { return size_; }
    std::uint64_t at() const { return begin_ + next_; }
    std::uint64_t left() const { return size_ - at(); }
    void seek(std::uint64_t place, std::string_view what);
    bool starts_with(std::string_view text);

    template <class Number>
    Number read(std::string_view what, std::endian order = std::endian::little) {
        if (sizeof(Number) > left()) fail_short(what, at() + sizeof(Number));
        const std::string_view there = ahead(sizeof(Number));
        unsigned char bytes[sizeof(Number)];
        for (std::size_t k = 0; k < sizeof(Number); ++k)
            bytes[order == std::endian::native ? k : sizeof(Number) - 1 - k] =
                static_cast<unsigned char>(there[k]);
        Number value;
        std::memcpy(&value, bytes, sizeof(Number));
        next_ += sizeof(Number);
        return value;
    }

    /// The next line without its end, valid until the next call; false where none is left.
    bool line(std::string_view& text);
    /// The same; false also for a last line that has no end.
    bool ended_line(std::string_view& text);
    /// What stands before the next blank or line end, valid until the next call, without going on;
    /// empty at the file's end.
    std::string_view word();
    void skip(std::size_t count) { next_ += count; }

    /// The file, wherever it stands now.
    std::unique_ptr<ByteSource> release() { return std::move(source_); }

  private:
    /// So many of the bytes that follow, fewer only where the file ends.
    std::string_view ahead(std::size_t count);
    /// Where one of `ends` is, counted from here; npos where the file has none.
    std::size_t find(std::string_view ends);
    [[noreturn]] void fail_short(std::string_view what, std::uint64_t wanted) const;

    std::string path_;
    std::unique_ptr<ByteSource> source_;
    std::uint64_t size_;
    std::string buffer_;
    std::uint64_t begin_ = 0; ///< of the buffer in the file
    std::size_t next_ = 0;    ///< in the buffer
};

} // namespace batten
