#include "commands.hpp"
#include "fit_files.hpp"
#include "fit_flags.hpp"
#include "parse.hpp"
#include "spline_outputs.hpp"
#include "system_files.hpp"

#include <batten/fit/solve_system.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/system_file.hpp>

#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace batten::command {

void check_system_output(const std::string& output, const std::vector<FileUse>& inputs) {
    if (extension(output) != ".sys" && !is_stream(output))
        throw InvalidInput(fmt::format("--output {}: a saved system .sys is written", output));
    check_outputs(std::array{FileUse{output, "--output"}}, inputs);
}

std::string system_words(const SystemSums& sums) {
    std::vector<int> degree;
    std::string closed;
    for (std::size_t k = 0; k < sums.axes.size(); ++k) {
        degree.push_back(sums.axes[k].degree());
        if (sums.axes[k].closed()) closed += fmt::format("{}{}", closed.empty() ? "" : ", ", k);
    }
    return fmt::format("system of degree {}, {} control points{}: {} samples in dimension {}, {}",
                       fmt::join(degree, "x"), fmt::join(free_shape(sums.axes), "x"),
                       closed.empty() ? "" : fmt::format(", closed along axis {}", closed),
                       sums.samples, sums.rhs.dim(),
                       sums.factors.size() == 1  ? "a banded matrix"
                       : !sums.factors.empty()   ? "a product of banded matrices"
                       : sums.grid_means.empty() ? "a stencil"
                                                 : "a stencil of a grid");
}

void write_system(const std::string& output, const SystemSums& sums, bool quiet) {
    save_system(output, sums);
    if (quiet) return;
    const bool taken = take_standard_output(std::array{FileUse{output, "--output"}});
    std::fputs((system_words(sums) + "\n").c_str(), taken ? stderr : stdout);
}

namespace {

struct MergeFlags {
    std::vector<std::string> systems;
    std::string output;
    bool quiet = false;
};

void merge(const MergeFlags& flags) {
    std::vector<FileUse> inputs;
    for (const std::string& path : flags.systems) inputs.push_back({path, "a system"});
    check_system_output(flags.output, inputs);
    SystemSums sums = load_system(flags.systems[0]);
    for (std::size_t k = 1; k < flags.systems.size(); ++k) {
        const SystemSums more = load_system(flags.systems[k]);
        try {
            sums = merged(std::move(sums), more);
        } catch (const InvalidInput& error) {
            throw InvalidInput(
                fmt::format("{}, {}: {}", flags.systems[0], flags.systems[k], error.what()));
        }
    }
    write_system(flags.output, sums, flags.quiet);
}

struct SolveFlags {
    std::string system;
    std::string control_points, knots, smooth;
    int smooth_order = 2;
    SplineOutputs outputs;
};

std::vector<FileUse> checked_outputs(const SolveFlags& flags, const CLI::App& app) {
    std::vector<FileUse> inputs{{flags.system, "the system"}};
    if (!flags.knots.empty()) inputs.push_back({flags.knots, "--knots"});
    std::vector<FileUse> written = checked(flags.outputs, app, inputs);
    if (app.count("--smooth-order") > 0 && flags.smooth.empty())
        throw InvalidInput("--smooth-order: it needs --smooth");
    return written;
}

void solve(const SolveFlags& flags, const CLI::App& app) {
    const std::vector<FileUse> written = checked_outputs(flags, app);
    SolveOptions options;
    options.smooth = smooth_options(flags.smooth, flags.smooth_order);
    if (!flags.control_points.empty())
        options.control_points = parse_shape("--control-points", flags.control_points);
    if (!flags.knots.empty()) options.knots = given_knots(flags.knots);
    SystemSums sums = load_system(flags.system);
    for (const std::string& output : flags.outputs.files)
        batten::check_holds(output, std::ssize(sums.axes), sums.rhs.dim());
    const SolveResult result = solve_system(std::move(sums), options);
    write(flags.outputs, written,
          {.spline = result.spline, .title = std::filesystem::path(flags.system).stem().string()},
          result.report.to_json(), result.report.full());
}

void add_solve_flags(CLI::App& sub, SolveFlags& flags) {
    sub.add_option("SYSTEM", flags.system, "Saved system .sys")->required();
    CLI::Option* size = sub.add_option("--control-points,-n", flags.control_points,
                                       "Coarser knots nested in the system's: every second "
                                       "breakpoint, every third, ... that divides their spans");
    sub.add_option("--knots", flags.knots,
                   "Any knots nested in the system's: a text file of one axis's knots, or a spline "
                   ".json whose knots to take")
        ->excludes(size);
    sub.add_option("--smooth", flags.smooth, "Smoothing: the factor of the roughness");
    sub.add_option("--smooth-order", flags.smooth_order,
                   "Derivative whose square is the roughness, 2 or 3")
        ->check(CLI::IsMember({2, 3}))
        ->capture_default_str();
    add_spline_outputs(sub, flags.outputs);
    one_value_each(sub);
}

} // namespace

void add_merge(CLI::App& app) {
    CLI::App* sub = app.add_subcommand("merge", "One saved system of the samples of several");
    auto flags = std::make_shared<MergeFlags>();
    sub->add_option("SYSTEMS", flags->systems, "Saved systems .sys over the same knots")
        ->required()
        ->expected(2, CLI::detail::expected_max_vector_size);
    sub->add_option("--output,-o", flags->output, "Saved system .sys")->required();
    sub->add_flag("--quiet,-q", flags->quiet, "Print nothing");
    sub->footer("Example:\n  batten merge monday.sys tuesday.sys -o both.sys");
    sub->callback([flags] { merge(*flags); });
}

void add_solve(CLI::App& app) {
    CLI::App* sub =
        app.add_subcommand("solve", "The spline of a saved system, without its samples");
    auto flags = std::make_shared<SolveFlags>();
    add_solve_flags(*sub, *flags);
    sub->footer("Examples:\n  batten solve both.sys -o part.json\n"
                "  batten solve both.sys -n 35 --smooth 1e-6 -o smoother.json -o smoother.step");
    sub->callback([flags, sub] { solve(*flags, *sub); });
}

} // namespace batten::command
