#include "commands.hpp"
#include "fit_flags.hpp"
#include "interrupt.hpp"
#include "progress.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace batten::command {

namespace {

/// A file's name without folder and extension.
std::string title_of(const std::string& path) {
    return path == "-" ? "points" : std::filesystem::path(path).stem().string();
}

void run(const FitFlags& flags, const CLI::App& fit_app) {
    method_entry(flags.method);
    for (const std::string& output : flags.outputs) check_output(output);
    if (!flags.summary.empty()) check_folder(flags.summary);
    Progress progress(flags.quiet ? Progress::Show::never : Progress::Show::when_slow);
    progress.say("reading " + flags.points);
    const Samples samples = samples_of(flags);
    FitOptions options = options_of(flags, fit_app, samples);
    options.cancelled = interrupted;
    options.observer = [&](const Iteration& now) {
        progress.say(fmt::format("iteration {}, gradient {:.2e}", now.number, now.gradient_norm));
        return Continue::yes;
    };
    progress.say("fitting");
    FitResult result = fit(samples, options);
    if (result.report.tolerance > 0 && flags.tolerance == 0 && flags.tolerances.empty())
        result.report.notes.emplace_back(
            "no size and no tolerance were stated: a thousandth of the data's diagonal was taken");
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
    if (!flags.summary.empty()) write_file(flags.summary, result.report.to_json());
    const bool stdout_taken = flags.summary == "-" || std::ranges::count(flags.outputs, "-") > 0;
    if (!flags.quiet) fmt::print(stdout_taken ? stderr : stdout, "{}", result.report.full());
    if (result.report.termination == Termination::tolerance_not_met) throw ToleranceNotMet{};
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
