#include "commands.hpp"
#include "exit_status.hpp"
#include "interrupt.hpp"
#include "standard_streams.hpp"

#include <batten/cad/cad.hpp>
#include <batten/core/errors.hpp>
#include <batten/core/names.hpp>

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <sstream>

namespace {

using namespace batten;

using namespace command;

constexpr const char* next_steps =
    "batten fits B-spline curves, surfaces and volumes to data points. Try\n\n"
    "  batten generate naca2412 -o wing.csv\n"
    "  batten fit wing.csv --control-points 20 -o wing.json -o wing.svg\n\n"
    "and `batten --help`, or `batten COMMAND --help`, for more.\n";

void add_commands(CLI::App& app) {
    command::add_fit(app);
    command::add_fair(app);
    command::add_assemble(app);
    command::add_merge(app);
    command::add_solve(app);
    command::add_evaluate(app);
    command::add_compare(app);
    command::add_info(app);
    command::add_convert(app);
    command::add_plot(app);
    command::add_generate(app);
    command::add_methods(app);
    command::add_reproduce(app);
}

/// Names that could stand in place of a word that was not expected.
std::vector<std::string> candidates(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    if (!word.starts_with("-")) {
        for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
            names.push_back(sub->get_name());
        return names;
    }
    const auto used = app.get_subcommands();
    for (const CLI::Option* option : (used.empty() ? app : *used.front()).get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

std::string words_for(const CLI::ParseError& error, const CLI::App& app) {
    const std::string what = error.what();
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError))
        return what.substr(0, what.find('\n'));
    const std::vector<std::string> extra = app.remaining(true);
    const auto flag =
        std::ranges::find_if(extra, [](const std::string& text) { return text.starts_with("-"); });
    const std::string whole = extra.empty() ? "" : flag == extra.end() ? extra.front() : *flag;
    const std::string word = whole.substr(0, whole.find('='));
    const std::vector<std::string> names = candidates(app, word);
    const std::vector<std::string_view> views(names.begin(), names.end());
    const std::string_view near = nearest_name(word, views);
    return fmt::format("unknown {} '{}'{}", word.starts_with("-") ? "option" : "argument", word,
                       near.empty() ? "; see --help" : fmt::format("; did you mean '{}'?", near));
}

/// The words on one line of bearable length, whatever names the user's files have.
std::string one_line(std::string_view words) {
    constexpr std::size_t most = 600;
    std::string line(words);
    if (line.size() > most) line.replace(most / 2, line.size() - most, "...");
    for (char& c : line)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    return line;
}

int complain(std::string_view what, ExitStatus status) {
    // where there is no standard error the status must do
    std::fputs(fmt::format("batten: {}\n", one_line(what)).c_str(), stderr);
    return status;
}

/// Without taking any memory.
int complain_of_memory() {
    std::fputs("batten: not enough memory; nothing was written\n", stderr);
    return machine_trouble;
}

int parse_and_run(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) fmt::print("{}", next_steps);
        return done;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) return complain(words_for(error, app), wrong_input);
        std::ostringstream help;
        app.exit(error, help, help);
        fmt::print("{}", help.str());
        return done;
    }
}

/// Everything between the arguments and the exit status.
int run(int argc, char** argv) {
    cad::register_formats();
    CLI::App app("Fits B-spline curves, surfaces and volumes to data points.", "batten");
    app.set_version_flag("--version", "batten " BATTEN_VERSION);
    app.footer("Exit status: 0 done; 2 wrong usage or input; 3 trouble with files, memory or "
               "threads; 4 written, but a stated goal was not reached; 130 interrupted.");
    app.require_subcommand(0, 1);
    add_commands(app);
    int status = done;
    try {
        status = parse_and_run(app, argc, argv);
    } catch (const command::GoalMissed& missed) {
        status = missed.words.empty() ? not_within : complain(missed.words, not_within);
    }
    finish_standard_output();
    return status;
}

} // namespace

int main(int argc, char** argv) {
    fill_closed_streams();
    watch_signals();
    try {
        return run(argc, argv);
    } catch (const InvalidInput& error) {
        return complain(error.what(), wrong_input);
    } catch (const SolverError& error) {
        return complain(error.what(), wrong_input);
    } catch (const FileError& error) {
        return complain(error.what(), machine_trouble);
    } catch (const std::bad_alloc&) {
        return complain_of_memory();
    } catch (const std::length_error&) { // a container asked for more than any machine has
        return complain_of_memory();
    } catch (const std::filesystem::filesystem_error& error) {
        return complain(fmt::format("{}: {}", error.path1().string(), error.code().message()),
                        machine_trouble);
    } catch (const std::system_error& error) {
        const bool printing = std::ferror(stdout) != 0;
        return complain(
            fmt::format("{}: {}",
                        printing ? "standard output: cannot be written" : "the system refused",
                        error.code().message()),
            machine_trouble);
    } catch (...) { // not one of ours: its words would say nothing to the user
        return complain("a mistake inside batten; please report it with the command and its files",
                        wrong_input);
    }
}
