#pragma once

#include <batten/spline/spline.hpp>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace batten::command {

/// Which of a file's splines is meant.
struct SplineInput {
    std::string path;
    Index entity = 0; ///< its number, counted from 1; 0: the only one
};

/// Adds SPLINE and --entity.
void add_spline_input(CLI::App& app, SplineInput& input);

/// Adds --entity, for commands that name their files themselves.
void add_entity(CLI::App& app, Index& entity);

/// Reads the spline; what of the file is not in it is said on standard error.
Spline read(const SplineInput& input);

/// Reads all splines of a file, or the one of this number; says the same.
std::vector<Spline> read_all(const SplineInput& input);

} // namespace batten::command
