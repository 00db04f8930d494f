#include "commands.hpp"
#include "fit_flags.hpp"
#include "interrupt.hpp"
#include "progress.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/report/html.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace batten::command {

namespace {

/// The command line as it was typed, words quoted where a shell needs it.
std::string command_line() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    std::string line = "batten";
    std::string word;
    std::getline(file, word, '\0');
    while (std::getline(file, word, '\0')) {
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVW"
                                                "XYZ0123456789-_=+.,:/@%") == std::string::npos;
        std::string quoted = "'";
        for (char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
        line += " " + (plain ? word : quoted + "'");
    }
    return line;
}

/// A file's name without folder and extension.
std::string title_of(const std::string& path) {
    return path == "-" ? "points" : std::filesystem::path(path).stem().string();
}

/// The points must not be overwritten by what is made of them.
void check_not_input(const std::string& output, const std::string& input) {
    std::error_code error;
    if (input != "-" && std::filesystem::equivalent(output, input, error))
        throw InvalidInput(fmt::format("{}: it is the file of the points", output));
}

void run(const FitFlags& flags, const CLI::App& fit_app) {
    method_entry(flags.method);
    for (const std::string& output : flags.outputs) check_output(output);
    if (!flags.summary.empty()) check_folder(flags.summary);
    if (!flags.report.empty()) {
        check_folder(flags.report);
        if (extension(flags.report) != ".html")
            throw InvalidInput(fmt::format("--report {}: a page .html is written", flags.report));
    }
    for (const std::string& output : flags.outputs) check_not_input(output, flags.points);
    Progress progress(flags.quiet ? Progress::Show::never : Progress::Show::when_slow);
    progress.say("reading " + flags.points);
    const Samples samples = samples_of(flags);
    FitOptions options = options_of(flags, fit_app, samples);
    if (!flags.report.empty() && flags.history) options.most_frames = 60;
    options.cancelled = interrupted;
    options.observer = [&](const Iteration& now) {
        progress.say(fmt::format("iteration {}, gradient {:.2e}", now.number, now.gradient_norm));
        return Continue::yes;
    };
    progress.say("fitting");
    FitResult result = fit(samples, options);
    if (result.report.termination == Termination::cancelled) throw Cancelled("interrupted");
    if (!result.report.usable())
        throw SolverError(
            "the iteration broke down: numbers left the finite range; nothing was written");
    const std::vector<double> deviations =
        flags.outputs.empty() && flags.report.empty()
            ? std::vector<double>()
            : parametric_deviations(result.spline, samples, result.parameters);
    Scene scene{.spline = result.spline,
                .samples = &samples,
                .title = title_of(flags.points),
                .deviations = &deviations};
    apply(flags.exported, scene);
    for (const std::string& output : flags.outputs) {
        progress.say("writing " + output);
        write_spline(output, scene);
    }
    if (!flags.report.empty()) {
        progress.say("writing " + flags.report);
        const PageOptions page{.command = command_line(),
                               .unit = fit_app.count("--unit") > 0 ? flags.exported.unit : ""};
        write_file(flags.report, html_page(result.report, scene, page));
    }
    if (!flags.summary.empty()) write_file(flags.summary, result.report.to_json());
    const bool stdout_taken = flags.summary == "-" || std::ranges::count(flags.outputs, "-") > 0;
    if (!flags.quiet) fmt::print(stdout_taken ? stderr : stdout, "{}", result.report.full());
    if (!result.report.goals_met()) throw GoalMissed{};
}

} // namespace

void add_fit(CLI::App& app) {
    CLI::App* fit = app.add_subcommand("fit", "Fit a curve, surface or volume to points");
    auto flags = std::make_shared<FitFlags>();
    add_flags(*fit, *flags);
    fit->footer("Examples:\n"
                "  batten fit section.csv --tolerance 0.01 --interpolate ends -o section.json\n"
                "  batten fit section.csv --control-points 20 -o section.json -o section.svg\n"
                "  batten fit terrain.npy --heights --spacing 60,60 --control-points 90x100 -o "
                "terrain.json\n"
                "  batten fit rose.csv -n 50 --method mlspia --stop-gradient 1e-8 --summary "
                "report.json --history");
    fit->callback([flags, fit] { run(*flags, *fit); });
}

} // namespace batten::command
