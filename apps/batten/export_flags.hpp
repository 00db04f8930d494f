#pragma once

#include <batten/io/spline_file.hpp>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace batten::command {

/// Flags of everything that writes splines.
struct ExportFlags {
    std::string unit = "mm";
    double chord_tolerance = 0;
    std::string date;
};

void add_export_flags(CLI::App& app, ExportFlags& flags);

/// Throws InvalidInput for a flag that no output shows, or that makes no sense; `report` is a page
/// or empty.
void check(const ExportFlags& flags, const CLI::App& app, const std::vector<std::string>& outputs,
           const std::string& report = {});

/// Enters the flags in what is written.
void apply(const ExportFlags& flags, Scene& scene);

/// Says on standard error, a line a file, what the files lose of the scene.
void print_notes(const std::vector<std::string>& outputs, const Scene& scene);

} // namespace batten::command
