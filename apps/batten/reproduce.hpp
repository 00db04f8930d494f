#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace batten::command {

/// Where a paper prints no figure.
inline constexpr double unprinted = std::numeric_limits<double>::quiet_NaN();

/// A figure of a paper beside ours.
struct Reproduced {
    std::string what;
    double published; ///< or unprinted
    double computed;
};

/// A figure (SVG) or a history (CSV) under its file's name.
struct Drawing {
    std::string name;
    std::string content;
};
using Drawings = std::vector<Drawing>;

/// One paper's examples: runs them, draws figures and histories, returns the table.
struct Paper {
    std::string name;
    std::string citation;
    std::string remark; ///< which data stand in for those that are not public
    std::vector<Reproduced> (*run)(Drawings& drawings);
};

std::span<const Paper> papers();

/// Peng and Li's experiments with SaLSPIA and what they compare it with.
std::vector<Reproduced> peng_li(Drawings& drawings);

} // namespace batten::command
