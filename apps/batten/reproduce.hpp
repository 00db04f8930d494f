#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace batten::command {

/// A figure of a paper beside ours.
struct Reproduced {
    std::string what;
    double published; ///< NaN where the paper prints none
    double computed;
};

/// One paper's examples: runs them, writes figures and histories to `folder`, returns the table.
struct Paper {
    std::string name;
    std::string citation;
    std::string remark; ///< which data stand in for those that are not public
    std::vector<Reproduced> (*run)(const std::filesystem::path& folder);
};

std::span<const Paper> papers();

} // namespace batten::command
