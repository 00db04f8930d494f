#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace batten::command {

/// Thrown once everything is written: the fit stands, but a stated goal was not reached.
struct GoalMissed {
    std::string words; ///< which, where no report was printed that says so
};

/// Each adds its subcommand; the work is done in the subcommand's callback and reports trouble by
/// exceptions.
void add_fit(CLI::App& app);
void add_assemble(CLI::App& app);
void add_merge(CLI::App& app);
void add_solve(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_compare(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_plot(CLI::App& app);
void add_fair(CLI::App& app);
void add_generate(CLI::App& app);
void add_methods(CLI::App& app);
void add_reproduce(CLI::App& app);

} // namespace batten::command
