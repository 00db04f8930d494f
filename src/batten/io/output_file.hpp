#pragma once

#include <filesystem>
#include <string>

namespace batten {

/// Puts `content` at `path`, alone in an OutputSet: a reader sees the old file or the whole new
/// one.
/// `-` is standard output. Throws FileError, and then the old file stays.
void write_file(const std::filesystem::path& path, std::string content);

/// The whole file; `-` is standard input. Throws FileError when it is missing, a folder or
/// unreadable, InvalidInput when it outgrows the memory.
std::string read_file(const std::filesystem::path& path);

/// Lower-case extension with its dot.
std::string extension(const std::filesystem::path& path);

/// The same of what a name ending in .gz holds: .csv of a.csv.gz.
std::string inner_extension(const std::filesystem::path& path);

/// The extension; a stream without one has that of `otherwise`.
std::string extension_or(const std::filesystem::path& path, std::string_view otherwise);

} // namespace batten
