#include "commands.hpp"
#include "fit_files.hpp"
#include "fit_flags.hpp"
#include "progress.hpp"

#include <batten/core/stopwatch.hpp>
#include <batten/io/output_set.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/report/html.hpp>
#include <batten/report/words.hpp>

#include <algorithm>
#include <cstdio>
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

/// Whether anything that is written shows the samples one by one.
bool shows_samples(const FitFlags& flags) {
    return !flags.report.empty() || std::ranges::any_of(flags.outputs, [](const auto& output) {
        return spline_format(output).samples;
    });
}

void run(const FitFlags& flags, const CLI::App& fit_app) {
    method_entry(flags.method);
    check_files(flags);
    check(flags.exported, fit_app, flags.outputs, flags.report);
    Progress progress(flags.quiet ? Progress::Show::never : Progress::Show::when_slow);
    progress.say("reading " + flags.points);
    Stopwatch watch;
    const Samples samples =
        samples_of(flags, [&](const ReadProgress& now) { progress.say_read(flags.points, now); });
    const double reading = watch.lap();
    FitOptions options = options_of(flags, fit_app, samples);
    check_holds(flags, samples, options);
    options.keep_per_sample = shows_samples(flags);
    if (!flags.report.empty() && flags.history) options.most_frames = 60;
    options.observer = [&](const Iteration& now) {
        progress.say(fmt::format("iteration {}, gradient {:.2e}", now.number, now.gradient_norm));
        return Continue::yes;
    };
    progress.say("fitting");
    FitResult result = fit(samples, options);
    auto& seconds = result.report.seconds;
    seconds.insert(seconds.begin(), {"reading", reading});
    if (!result.report.usable())
        throw SolverError(
            "the iteration broke down: numbers left the finite range; nothing was written");
    Scene scene{.spline = result.spline,
                .samples = &samples,
                .title = title_of(flags.points),
                .deviations = options.keep_per_sample ? &result.deviations : nullptr,
                .parameters = options.keep_per_sample ? &result.parameters : nullptr};
    apply(flags.exported, scene);
    OutputSet outputs;
    for (const std::string& output : flags.outputs) {
        progress.say("writing " + output);
        outputs.add(output, spline_content(output, scene));
    }
    if (!flags.report.empty()) {
        progress.say("writing " + flags.report);
        const PageOptions page{.command = command_line(),
                               .unit = fit_app.count("--unit") > 0 ? flags.exported.unit : ""};
        outputs.add(flags.report, html_page(result.report, scene, page));
    }
    if (!flags.summary.empty()) outputs.add(flags.summary, result.report.to_json());
    outputs.put_in_place();
    if (!flags.quiet) {
        print_notes(flags.outputs, scene);
        std::fputs(result.report.full().c_str(), writes_standard_output(flags) ? stderr : stdout);
    }
    if (!result.report.goals_met())
        throw GoalMissed{flags.quiet ? missed_words(result.report) : ""};
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
