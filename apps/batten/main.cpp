#include "commands.hpp"
#include "interrupt.hpp"

#include <batten/cad/cad.hpp>
#include <batten/core/errors.hpp>
#include <batten/core/names.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace {

using namespace batten;

enum ExitStatus { done = 0, wrong_input = 2, file_trouble = 3, not_within = 4, stopped = 130 };

constexpr const char* next_steps =
    "batten fits B-spline curves, surfaces and volumes to data points. Try\n\n"
    "  batten generate naca2412 -o wing.csv\n"
    "  batten fit wing.csv --control-points 20 -o wing.json -o wing.svg\n\n"
    "and `batten --help`, or `batten COMMAND --help`, for more.\n";

void add_commands(CLI::App& app) {
    command::add_fit(app);
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

int complain(std::string_view what, int status) {
    fmt::print(stderr, "batten: {}\n", what);
    return status;
}

} // namespace

int main(int argc, char** argv) {
    command::watch_interrupts();
    cad::register_formats({.program = {}, .cancelled = command::interrupted});
    CLI::App app("Fits B-spline curves, surfaces and volumes to data points.", "batten");
    app.set_version_flag("--version", "batten " BATTEN_VERSION);
    app.footer("Exit status: 0 done; 2 wrong usage or input; 3 file trouble; 4 written, but a "
               "stated goal was not reached; 130 interrupted.");
    app.require_subcommand(0, 1);
    add_commands(app);
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) fmt::print("{}", next_steps);
        return command::interrupted() ? stopped : done;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        return complain(words_for(error, app), wrong_input);
    } catch (const command::GoalMissed&) {
        return not_within;
    } catch (const Cancelled&) {
        return complain("interrupted; nothing was written", stopped);
    } catch (const FileError& error) {
        return complain(error.what(), file_trouble);
    } catch (const InvalidInput& error) {
        return complain(error.what(), wrong_input);
    } catch (const std::bad_alloc&) {
        return complain("not enough memory", wrong_input);
    } catch (const std::exception& error) {
        return complain(error.what(), wrong_input);
    }
}
