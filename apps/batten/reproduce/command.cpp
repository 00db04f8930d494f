#include "../commands.hpp"
#include "papers.hpp"

#include <batten/core/errors.hpp>
#include <batten/core/names.hpp>
#include <batten/io/output_set.hpp>

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace batten::command {

namespace {

void print(const Paper& paper, const std::vector<Table>& tables) {
    fmt::print("{}: {}\n{}\n\n", paper.name, paper.citation, paper.remark);
    for (const Table& table : tables) fmt::print("{}", in_words(table));
}

/// A line for each table of all the papers.
void print_verdicts(const std::vector<std::pair<std::string, std::vector<Table>>>& all) {
    fmt::print("In short\n");
    for (const auto& [paper, tables] : all)
        for (const Table& table : tables)
            fmt::print("  {:<9}{:<54} {}\n", paper, table.name, verdict(table));
    fmt::print("\n");
}

/// Asked before the work: throws FileError for a folder that nothing can be put into.
void check_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder, error)) output_place(folder / "figure");
}

void put_into(const std::filesystem::path& folder, const std::vector<Drawing>& drawings) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw FileError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
    OutputSet outputs;
    for (const Drawing& drawing : drawings) outputs.add(folder / drawing.name, drawing.content);
    outputs.put_in_place();
}

void reproduce(const std::string& wanted, const std::filesystem::path& folder,
               const std::filesystem::path& data) {
    std::vector<std::string_view> names{"all"};
    for (const Paper& paper : papers()) names.push_back(paper.name);
    if (std::ranges::count(names, wanted) == 0)
        throw InvalidInput(unknown_name("paper", wanted, names));
    if (!data.empty() && !std::filesystem::is_directory(data))
        throw FileError(fmt::format("{}: no folder", data.string()));
    check_folder(folder);
    Workshop workshop{.data = data};
    std::vector<std::pair<std::string, std::vector<Table>>> all;
    for (const Paper& paper : papers()) {
        if (wanted != "all" && paper.name != wanted) continue;
        all.emplace_back(paper.name, paper.run(workshop));
        print(paper, all.back().second);
    }
    print_verdicts(all);
    put_into(folder, workshop.drawings);
    fmt::print("figures (SVG) and histories (CSV) are in {}\n", folder.string());
}

} // namespace

void add_reproduce(CLI::App& app) {
    struct Flags {
        std::string paper = "all", folder = "reproduced", data;
    };
    CLI::App* sub =
        app.add_subcommand("reproduce", "The papers' tables, published beside computed");
    auto flags = std::make_shared<Flags>();
    sub->add_option("PAPER", flags->paper, "pia, epia, mlspia, clspia, salspia, race or all")
        ->capture_default_str();
    sub->add_option("--folder", flags->folder, "Where figures and histories go")
        ->capture_default_str();
    sub->add_option("--data", flags->data,
                    "Folder with the authors' data (glyph577.csv, profile205.csv, ...), in place "
                    "of stand-ins");
    sub->footer("Example:\n  batten reproduce mlspia");
    sub->callback([flags] { reproduce(flags->paper, flags->folder, flags->data); });
}

} // namespace batten::command
