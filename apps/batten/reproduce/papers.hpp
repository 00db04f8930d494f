#pragma once

#include "tables.hpp"

#include <batten/fit/fit.hpp>

#include <filesystem>
#include <optional>
#include <span>

namespace batten::command {

/// A figure (SVG) or a history (CSV) under its file's name.
struct Drawing {
    std::string name;
    std::string content;
};

/// What examples are run with: the authors' data where the caller has them, and a place for what is
/// drawn.
struct Workshop {
    std::filesystem::path data{}; ///< a folder, or empty
    std::vector<Drawing> drawings{};

    bool has(std::string_view file) const;
    /// The points of that file in `data`, when it is there. Throws FileError when it cannot be
    /// read.
    std::optional<Samples> real(std::string_view file) const;
    /// The same for a table of numbers.
    std::optional<PointSet> real_table(std::string_view file) const;
};

/// One paper's examples.
struct Paper {
    std::string name;
    std::string citation;
    std::string remark;
    std::vector<Table> (*run)(Workshop& workshop);
};

std::span<const Paper> papers();

std::vector<Table> lin_wang_dong(Workshop& workshop);
std::vector<Table> lin_zhang(Workshop& workshop);
std::vector<Table> huang_wang(Workshop& workshop);
std::vector<Table> chang_ma_deng(Workshop& workshop);
std::vector<Table> peng_li(Workshop& workshop);
/// All iterations on ten problems.
std::vector<Table> race(Workshop& workshop);

/// Fits with history; draws the history, the steps asked for, the limit and its curvature comb, all
/// under names that begin with `stem`.
FitResult drawn_fit(const Samples& samples, FitOptions options, Workshop& workshop,
                    const std::string& stem, const std::vector<Index>& steps);

} // namespace batten::command
