#pragma once

#include "export_flags.hpp"

#include <batten/io/output_place.hpp>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace batten::command {

/// Where a spline that a command made goes, and the account of how.
struct SplineOutputs {
    std::vector<std::string> files;
    std::string summary;
    bool quiet = false;
    ExportFlags exported;
};

void add_spline_outputs(CLI::App& app, SplineOutputs& outputs);

/// Asked before anything is read: throws InvalidInput or FileError for outputs that cannot be
/// written, or that are also read or written twice. Returns them.
std::vector<FileUse> checked(const SplineOutputs& outputs, const CLI::App& app,
                             const std::vector<FileUse>& inputs);

/// Writes what was `checked`: the spline with the account as JSON; says the account in words.
void write(const SplineOutputs& outputs, const std::vector<FileUse>& written, Scene scene,
           const std::string& json, const std::string& words);

} // namespace batten::command
