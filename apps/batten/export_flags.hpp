#pragma once

#include <batten/io/spline_file.hpp>

#include <CLI/CLI.hpp>
#include <string>

namespace batten::command {

/// Flags of everything that writes splines.
struct ExportFlags {
    std::string unit = "mm";
    double chord_tolerance = 0;
    std::string date;
};

void add_export_flags(CLI::App& app, ExportFlags& flags);

/// Enters the flags in what is written.
void apply(const ExportFlags& flags, Scene& scene);

} // namespace batten::command
