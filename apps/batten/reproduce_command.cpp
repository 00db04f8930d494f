#include "commands.hpp"
#include "reproduce.hpp"

#include <batten/core/errors.hpp>
#include <batten/core/names.hpp>
#include <batten/io/output_set.hpp>

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace batten::command {

namespace {

void print(const Paper& paper, const std::vector<Reproduced>& table) {
    fmt::print("{}: {}\n{}\n\n  {:<58}{:>15}{:>15}{:>10}\n", paper.name, paper.citation,
               paper.remark, "", "published", "computed", "ratio");
    for (const Reproduced& row : table) {
        const bool known = std::isfinite(row.published);
        fmt::print("  {:<58}{:>15}{:>15.7g}{:>10}\n", row.what,
                   known ? fmt::format("{:.7g}", row.published) : "-", row.computed,
                   known ? fmt::format("{:.4f}", row.computed / row.published) : "-");
    }
    fmt::print("\n");
}

/// Asked before the work: throws FileError for a folder that nothing can be put into.
void check_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder, error)) output_place(folder / "figure");
}

void put_into(const std::filesystem::path& folder, const Drawings& drawings) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw FileError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
    OutputSet outputs;
    for (const Drawing& drawing : drawings) outputs.add(folder / drawing.name, drawing.content);
    outputs.put_in_place();
}

void reproduce(const std::string& wanted, const std::filesystem::path& folder) {
    std::vector<std::string_view> names{"all"};
    bool found = wanted == "all";
    for (const Paper& paper : papers()) {
        names.push_back(paper.name);
        found = found || paper.name == wanted;
    }
    if (!found) throw InvalidInput(unknown_name("paper", wanted, names));
    check_folder(folder);
    Drawings drawings;
    for (const Paper& paper : papers())
        if (wanted == "all" || paper.name == wanted) print(paper, paper.run(drawings));
    put_into(folder, drawings);
    fmt::print("figures (SVG) and histories (CSV) are in {}\n", folder.string());
}

} // namespace

void add_reproduce(CLI::App& app) {
    struct Flags {
        std::string paper = "all", folder = "reproduced";
    };
    CLI::App* sub =
        app.add_subcommand("reproduce", "The papers' tables, published beside computed");
    auto flags = std::make_shared<Flags>();
    sub->add_option("PAPER", flags->paper, "pia, epia, mlspia, clspia, salspia or all")
        ->capture_default_str();
    sub->add_option("--folder", flags->folder, "Where figures and histories go")
        ->capture_default_str();
    sub->footer("Example:\n  batten reproduce mlspia");
    sub->callback([flags] { reproduce(flags->paper, flags->folder); });
}

} // namespace batten::command
