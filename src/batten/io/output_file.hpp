#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace batten {

/// Puts `content` at `path` under a temporary name and renames it: a reader sees the old file or
/// the whole new one. `-` is standard output. Throws FileError and removes the temporary file when
/// anything fails.
void write_file(const std::filesystem::path& path, std::string_view content);

/// The whole file; `-` is standard input. Throws FileError when it is missing, a folder or
/// unreadable.
std::string read_file(const std::filesystem::path& path);

/// Lower-case extension with its dot.
std::string extension(const std::filesystem::path& path);

} // namespace batten
