#pragma once

#include <batten/io/points_file.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace batten {

/// Bytes that are read from the first to the last, as often as needed.
class ByteSource {
  public:
    ByteSource() = default;
    virtual ~ByteSource() = default;
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    /// Number of bytes; -1 where only the end tells.
    virtual std::int64_t size() const = 0;
    /// Puts the next bytes into `into` and says how many: fewer than there is room for at the end
    /// only. Throws FileError where the file cannot be read on or has changed since it was opened.
    virtual std::size_t read(std::span<char> into) = 0;
    /// The byte to go on from: the first, or where the size is known any up to the end.
    virtual void seek(std::uint64_t place) = 0;
    /// Bytes of the file read so far, in all passes.
    virtual std::uint64_t bytes_read() const { return 0; }
    /// Throws FileError where the file has changed since it was opened.
    virtual void check_unchanged() const {}
    /// What was done so that the bytes could be read again; empty for nothing worth a word.
    virtual std::string note() const { return {}; }
};

/// The bytes of a file, `-` of standard input; what a name ending in .gz holds uncompressed. What
/// comes through a pipe is kept in an unnamed temporary file where `again` asks for it, so that it
/// can be read from its beginning again.
/// Throws FileError when it is missing, a folder or unreadable.
enum class ReadAgain { no, yes };
std::unique_ptr<ByteSource> open_bytes(const std::filesystem::path& path, ReadAgain again,
                                       const ReadObserver& observer = {});

/// Bytes in memory, which must outlive it.
std::unique_ptr<ByteSource> bytes_in_memory(std::string_view bytes);

/// The uncompressed bytes of gzip's format, one member or several.
std::unique_ptr<ByteSource> uncompressed(const std::filesystem::path& path,
                                         std::unique_ptr<ByteSource> compressed);

/// `stream` with what was read of it kept in an unnamed temporary file, for a second pass.
std::unique_ptr<ByteSource> spooled(const std::string& name, std::unique_ptr<ByteSource> stream);

/// `source` itself where its size is known; else all of it kept in an unnamed temporary file.
/// Throws FileError when there is nothing in it.
std::unique_ptr<ByteSource> sized_and_not_empty(const std::filesystem::path& path,
                                                std::unique_ptr<ByteSource> source);

/// What messages call the file: its path, or standard input.
std::string input_name(const std::filesystem::path& path);

} // namespace batten
