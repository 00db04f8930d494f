#pragma once

#include <filesystem>
#include <string_view>

namespace batten::cad {

/// Throws FileError for an IGES text without its last record, the terminate section, with other
/// records than that one counts, or whose B-splines lack numbers: Open CASCADE reads what is there
/// and says nothing. What is no IGES text passes.
void check_whole_iges(const std::filesystem::path& path, std::string_view content);

} // namespace batten::cad
