#include "commands.hpp"
#include "parse.hpp"
#include "spline_input.hpp"
#include "spline_outputs.hpp"

#include <batten/fair/fair.hpp>
#include <batten/io/output_place.hpp>
#include <batten/io/points_file.hpp>

#include <memory>

namespace batten::command {

namespace {

struct Flags {
    SplineInput spline;
    std::string weights, points;
    std::vector<std::string> set;
    FairOptions options;
    SplineOutputs outputs;
};

FairOptions options_of(const Flags& flags) {
    FairOptions options = flags.options;
    if (!flags.weights.empty()) options.weights = read_table(flags.weights).values();
    if (!flags.points.empty()) options.points = index_list("--points", flags.points);
    options.settings = parse_settings(flags.set);
    return options;
}

/// What is written, and no file of it one that is read.
std::vector<FileUse> checked_outputs(const Flags& flags, const CLI::App& app) {
    std::vector<FileUse> inputs{{flags.spline.path, "the spline"}};
    if (!flags.weights.empty()) inputs.push_back({flags.weights, "--weights"});
    if (!is_list(flags.points)) inputs.push_back({flags.points, "--points"});
    return checked(flags.outputs, app, inputs);
}

void run(const Flags& flags, const CLI::App& app) {
    const std::vector<FileUse> written = checked_outputs(flags, app);
    const FairResult result = fair(read(flags.spline), options_of(flags));
    if (result.report.course.termination == Termination::breakdown)
        throw SolverError(
            "the iteration broke down: numbers left the finite range; nothing was written");
    write(flags.outputs, written,
          {.spline = result.spline,
           .title = std::filesystem::path(flags.spline.path).stem().string()},
          result.report.to_json(), result.report.full());
}

void add_flags(CLI::App& sub, Flags& flags) {
    FairOptions& options = flags.options;
    add_spline_input(sub, flags.spline);
    sub.add_option("--weight", options.weight,
                   "0 leaves a control point, nearly 1 makes it as fair as its neighbours allow")
        ->capture_default_str();
    sub.add_option(
           "--weights", flags.weights,
           "File of weights, one per control point (a closed axis's repeated ones left out)")
        ->excludes("--weight");
    sub.add_option("--order", options.order, "Order of the derivatives that count: 1, 2 or 3")
        ->capture_default_str();
    sub.add_option("--points", flags.points,
                   "Only these control points move: a list like 3,4,5 or a file of numbers from 0 "
                   "(all but the ends of open axes)");
    sub.add_option("--automatic", options.automatic,
                   "Only so many move, those that gain most by themselves")
        ->check(CLI::PositiveNumber)
        ->excludes("--points");
    sub.add_option("--method,-m", options.method,
                   "direct, or an iteration: lin2018 (progressive-iterative fairing), cg, ...")
        ->capture_default_str();
    sub.add_option("--set", flags.set, "A setting of the method: name=value; may be repeated");
    sub.add_option("--max-iterations", options.stop.max_iterations, "Most iterations")
        ->capture_default_str();
    sub.add_option("--stop-relative-gradient", options.stop.relative_gradient,
                   "Stop when the gradient is this small beside the first one")
        ->capture_default_str();
    add_spline_outputs(sub, flags.outputs);
    one_value_each(sub);
}

} // namespace

void add_fair(CLI::App& app) {
    CLI::App* sub = app.add_subcommand("fair", "A fairer spline near a given one");
    auto flags = std::make_shared<Flags>();
    add_flags(*sub, *flags);
    sub->footer("Examples:\n  batten fair part.json --weight 1e-5 -o fairer.json\n"
                "  batten fair part.step --automatic 3 -o fairer.step\n"
                "  batten fair part.json -m lin2018 --max-iterations 20 -o halfway.json");
    sub->callback([flags, sub] { run(*flags, *sub); });
}

} // namespace batten::command
