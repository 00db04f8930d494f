#include "commands.hpp"
#include "fit_flags.hpp"
#include "parse.hpp"
#include "spline_input.hpp"
#include "system_files.hpp"

#include <batten/fit/assemble_system.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/system_file.hpp>

#include <fmt/format.h>
#include <memory>

namespace batten::command {

namespace {

struct Flags {
    FitFlags fit; ///< what is said of the points, for every file
    std::vector<std::string> files;
    std::vector<std::string> weights;
    std::string domain;
    std::string knots_of;
    std::string output;
    bool quiet = false;
};

void check_files(const Flags& flags) {
    std::vector<FileUse> inputs;
    for (const std::string& path : flags.files) inputs.push_back({path, "the points"});
    for (const std::string& path : flags.weights) inputs.push_back({path, "--weights"});
    for (const std::string& path : flags.fit.parameters) inputs.push_back({path, "--parameters"});
    const std::string& knots = flags.fit.knots;
    if (!knots.empty() && knots != "data" && knots != "uniform")
        inputs.push_back({knots, "--knots"});
    if (!flags.knots_of.empty()) inputs.push_back({flags.knots_of, "--knots-of"});
    check_system_output(flags.output, inputs);
}

/// Several files share one space, which the first one's points must not decide alone.
void check_several(const Flags& flags) {
    const std::size_t files = flags.files.size();
    const std::size_t parameters = flags.fit.parameters.size();
    if (parameters % files != 0)
        throw InvalidInput(fmt::format("--parameters: {} files given for {} files of points; for "
                                       "each as many are needed as it has axes",
                                       parameters, files));
    if (!flags.weights.empty() && flags.weights.size() != files)
        throw InvalidInput(fmt::format("--weights: {} given for {} files of points; one for each "
                                       "is needed",
                                       flags.weights.size(), files));
    const bool words = flags.fit.knots == "data" || flags.fit.knots == "uniform";
    if (files > 1 && flags.domain.empty() && flags.knots_of.empty() &&
        (flags.fit.knots.empty() || words))
        throw InvalidInput("several files share their knots: state them by --domain and "
                           "--control-points, --knots FILE or --knots-of");
}

/// `0..1`, or one such for each axis: `0..1,0..2`.
std::vector<std::array<double, 2>> parse_domain(const std::string& text) {
    std::vector<std::array<double, 2>> result;
    for (std::size_t at = 0; at <= text.size() && !text.empty();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        const std::string part = text.substr(at, end - at);
        const std::size_t dots = part.find("..");
        if (dots == std::string::npos)
            throw InvalidInput(fmt::format(
                "--domain {}: 0..1, or one such for each axis, 0..1,0..2, is needed", text));
        result.push_back({parse_number("--domain", part.substr(0, dots)),
                          parse_number("--domain", part.substr(dots + 2))});
        at = end + 1;
    }
    return result;
}

/// The axes of a saved system or of a spline.
std::vector<KnotVector> axes_of(const std::string& path) {
    return extension(path) == ".sys" ? load_system(path).axes : read({path}).axes();
}

void take_knots(const std::vector<KnotVector>& axes, ShapeOptions& shape) {
    shape.degree.clear();
    shape.closures.clear();
    for (const KnotVector& axis : axes) {
        shape.degree.push_back(axis.degree());
        shape.closures.push_back(axis.closure());
        shape.knots.emplace_back(axis.knots().begin(), axis.knots().end());
    }
}

/// What is said of one file of several.
FitFlags flags_for(const Flags& flags, std::size_t file) {
    FitFlags result = flags.fit;
    result.points = flags.files[file];
    const auto each = static_cast<std::ptrdiff_t>(flags.fit.parameters.size() / flags.files.size());
    const auto first = flags.fit.parameters.begin() + each * static_cast<std::ptrdiff_t>(file);
    result.parameters.assign(first, first + each);
    if (!flags.weights.empty()) result.weights = flags.weights[file];
    return result;
}

SystemSums assembled(const Flags& flags, const CLI::App& app, std::size_t file,
                     const std::vector<KnotVector>& axes) {
    const FitFlags own = flags_for(flags, file);
    const Samples samples = samples_of(own);
    AssembleOptions options{shape_options(own, app, samples), parse_domain(flags.domain)};
    if (!axes.empty()) take_knots(axes, options.shape);
    const bool in_plane = options.shape.projection || samples.kind() == SampleKind::cloud;
    if (file > 0 && own.parameters.empty() && !in_plane)
        throw InvalidInput("every file after the first needs --parameters of its own: from its "
                           "points alone they would begin anew");
    return assemble_system(samples, options);
}

void run(const Flags& flags, const CLI::App& app) {
    check_files(flags);
    check_several(flags);
    const auto axes = flags.knots_of.empty() ? std::vector<KnotVector>{} : axes_of(flags.knots_of);
    SystemSums sums;
    for (std::size_t k = 0; k < flags.files.size(); ++k) {
        try {
            SystemSums own = assembled(flags, app, k, axes);
            sums = k == 0 ? std::move(own) : merged(std::move(sums), own);
        } catch (const InvalidInput& error) {
            if (flags.files.size() == 1) throw;
            throw InvalidInput(fmt::format("{}: {}", flags.files[k], error.what()));
        }
    }
    write_system(flags.output, sums, flags.quiet);
}

void add_flags(CLI::App& sub, Flags& flags) {
    sub.add_option("POINTS", flags.files,
                   "Files of points, one after the other into one system: .csv .txt .xyz .dat .npy "
                   ".ply .obj .stl .las")
        ->required();
    add_data_flags(sub, flags.fit);
    sub.add_option("--domain", flags.domain,
                   "Evenly spaced knots over these parameters: 0..1, or one such for each axis, "
                   "0..1000,0..500; a cloud's coordinates are then its parameters as they stand")
        ->group("Shape");
    CLI::Option* of = sub.add_option("--knots-of", flags.knots_of,
                                     "Degrees, closed axes and knots of a saved system .sys or of "
                                     "a spline")
                          ->group("Shape");
    for (const char* name : {"--knots", "--control-points", "--domain", "--degree", "--closed"})
        of->excludes(sub.get_option(name));
    sub.get_option("--domain")->excludes("--knots");
    sub.add_option("--weights", flags.weights,
                   "File of one positive weight per sample, one for each file of points")
        ->group("Points");
    sub.add_option("--output,-o", flags.output, "Saved system .sys")->required()->group("Output");
    sub.add_flag("--quiet,-q", flags.quiet, "Print nothing")->group("Output");
    one_value_each(sub);
}

} // namespace

void add_assemble(CLI::App& app) {
    CLI::App* sub = app.add_subcommand(
        "assemble", "The normal system of points, to be merged and solved without them");
    auto flags = std::make_shared<Flags>();
    add_flags(*sub, *flags);
    sub->footer("Examples:\n"
                "  batten assemble tile1.las tile2.las --domain 0..1000,0..500 -n 67x35 -o a.sys\n"
                "  batten assemble tuesday.csv --parameters t.csv --knots-of a.sys -o b.sys\n"
                "then batten merge a.sys b.sys -o c.sys; batten solve c.sys -o part.json");
    sub->callback([flags, sub] { run(*flags, *sub); });
}

} // namespace batten::command
