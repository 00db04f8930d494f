#pragma once

#include <batten/system/system_sums.hpp>

#include <filesystem>
#include <string>

namespace batten {

/// What a saved system's file holds: every number of the sums, exact (docs/formats.md).
std::string system_content(const SystemSums& sums);

/// Parses such content; throws FileError with path (for messages) and what is wrong: not a saved
/// system, another version, cut off, a checksum that does not match, numbers that no samples have.
SystemSums parse_system(const std::filesystem::path& path, std::string_view content);

/// Writes system_content. Throws FileError; an existing file is replaced only by a complete one.
void save_system(const std::filesystem::path& path, const SystemSums& sums);

/// Reads a saved system. Throws FileError.
SystemSums load_system(const std::filesystem::path& path);

} // namespace batten
