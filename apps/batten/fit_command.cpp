#include "commands.hpp"
#include "interrupt.hpp"
#include "parse.hpp"
#include "progress.hpp"

#include <batten/fit/fit.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace batten::command {

namespace {

/// The flags as typed.
struct FitFlags {
    std::string points;
    std::vector<std::string> outputs;
    std::string summary;
    bool history = false;
    std::string grid;
    bool heights = false;
    std::string spacing = "1,1";
    std::string control_points;
    std::vector<int> degree{3};
    std::string closed;
    std::string parametrize = "chord";
    std::vector<std::string> parameters;
    std::string knots = "data";
    std::string method = "auto";
    std::string initial = "data";
    std::vector<std::string> set;
    Index max_iterations = StopRule{}.max_iterations;
    double stop_gradient = 0;
    double stop_relative_gradient = 0;
    double stop_deviation = 0;
    std::string weights;
    double tolerance = 0;
    std::string tolerances;
    Index max_control_points = 0;
    std::string corners = "auto";
    std::string interpolate;
    std::string preserve;
    std::string moving;
    int threads = 0;
    bool quiet = false;
};

/// Options of the plan that this version does not have: refused by name, never ignored.
constexpr const char* planned[] = {"--project", "--tangents", "--boundary", "--robust",
                                   "--smooth",  "--unit",     "--report"};

void add_shape_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--control-points,-n", flags.control_points,
                   "Number of control points: 30, 20x30 or 8x8x8")
        ->group("Size");
    fit.add_option("--tolerance,-t", flags.tolerance,
                   "Every sample within this distance, with as few control points as it takes")
        ->group("Size");
    fit.add_option("--tolerances", flags.tolerances, "File of one tolerance per sample")
        ->group("Size");
    fit.add_option("--max-control-points", flags.max_control_points,
                   "Not more than these for a tolerance")
        ->check(CLI::PositiveNumber)
        ->group("Size");
    fit.add_option("--corners", flags.corners,
                   "auto, none, or a list of samples: where a curve may bend sharply")
        ->group("Size")
        ->capture_default_str();
    fit.add_option("--degree,-p", flags.degree, "Degree 1 to 9, one for all axes or one each")
        ->delimiter(',')
        ->group("Shape")
        ->capture_default_str();
    fit.add_option("--closed", flags.closed,
                   "Closed curve; for a grid the closed axes, as --closed=0 or --closed=0,1")
        ->expected(0, 1)
        ->group("Shape")
        ->default_str("all");
    fit.add_option("--parametrize", flags.parametrize, "chord, centripetal or uniform")
        ->group("Shape")
        ->capture_default_str();
    fit.add_option("--parameters", flags.parameters,
                   "File of parameters, one per sample; for a grid one file per axis")
        ->group("Shape");
    fit.add_option("--knots", flags.knots,
                   "data (NURBS Book 9.69), uniform, a text file of one axis's knots, or a spline "
                   ".json whose knots to take")
        ->group("Shape")
        ->capture_default_str();
    fit.add_option("--grid", flags.grid, "Grid shape of the points, last axis fastest: 81x81")
        ->group("Points");
    fit.add_flag("--heights", flags.heights, "The file is a table of heights over a regular grid")
        ->group("Points");
    fit.add_option("--spacing", flags.spacing, "Grid distances DX,DY of --heights")
        ->group("Points")
        ->capture_default_str();
    fit.add_option("--weights", flags.weights, "File of one positive weight per sample")
        ->group("Points");
}

void add_method_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--method,-m", flags.method,
                   "auto, direct, or an iteration: see `batten methods`")
        ->group("Method")
        ->capture_default_str();
    fit.add_option("--initial", flags.initial,
                   "data, zero, or a file of control points or a spline .json")
        ->group("Method")
        ->capture_default_str();
    fit.add_option("--set", flags.set, "The method's own numbers: name=value")->group("Method");
    fit.add_option("--moving", flags.moving, "Local PIA: only these control points move: 3,4,5")
        ->group("Method");
    fit.add_option("--interpolate", flags.interpolate,
                   "Samples to hit exactly: ends, a list 0,20,40, or a file of indices")
        ->group("Must hold");
    fit.add_option("--preserve", flags.preserve,
                   "convexity or inflections of the initial control polygon, at every step")
        ->group("Must hold");
    fit.add_option("--max-iterations", flags.max_iterations, "Most iterations")
        ->check(CLI::NonNegativeNumber)
        ->group("Stop")
        ->capture_default_str();
    fit.add_option("--stop-gradient", flags.stop_gradient,
                   "Stop at this Frobenius norm of A^T(Q - AP)")
        ->check(CLI::NonNegativeNumber)
        ->group("Stop");
    fit.add_option("--stop-relative-gradient", flags.stop_relative_gradient,
                   "Stop at this part of its first value (1e-10 when no other stop is given)")
        ->check(CLI::NonNegativeNumber)
        ->group("Stop");
    fit.add_option("--stop-deviation", flags.stop_deviation, "Stop when every sample is this close")
        ->check(CLI::NonNegativeNumber)
        ->group("Stop");
    fit.add_option("--threads", flags.threads, "Threads; 0 takes every core")
        ->check(CLI::NonNegativeNumber)
        ->group("Machine")
        ->capture_default_str();
    fit.add_flag("--quiet,-q", flags.quiet, "Say nothing unless something is wrong")
        ->group("Machine");
    for (const char* name : planned)
        fit.add_option_function<std::string>(name,
                                             [name](const std::string&) {
                                                 throw InvalidInput(
                                                     fmt::format("{}: not available yet", name));
                                             })
            ->group("");
}

std::vector<Closure> closures(const FitFlags& flags, bool given, Index axes) {
    if (!given) return {Closure::open};
    if (flags.closed.empty() || flags.closed == "all") return {Closure::closed};
    std::vector<Closure> result(static_cast<std::size_t>(axes), Closure::open);
    for (std::size_t at = 0; at <= flags.closed.size();) {
        const std::size_t end = std::min(flags.closed.find(',', at), flags.closed.size());
        const double axis = parse_number("--closed", flags.closed.substr(at, end - at));
        if (axis != std::floor(axis) || axis < 0 || axis >= static_cast<double>(axes))
            throw InvalidInput(
                fmt::format("--closed {}: the axes are 0 to {}", flags.closed, axes - 1));
        result[static_cast<std::size_t>(axis)] = Closure::closed;
        at = end + 1;
    }
    return result;
}

std::optional<Parameters> given_parameters(const FitFlags& flags) {
    if (flags.parameters.empty()) return std::nullopt;
    Parameters parameters;
    for (const std::string& path : flags.parameters) {
        PointSet table = read_table(path);
        if (table.dim() > 1 && table.size() > 1 &&
            flags.parameters.size() == 1) { // a cloud: u, v per sample
            parameters.scattered = std::move(table);
            return parameters;
        }
        if (table.dim() != 1 && table.size() != 1)
            throw InvalidInput(fmt::format("{}: one parameter per line is needed, got {} columns",
                                           path, table.dim()));
        parameters.axes.push_back(table.values());
    }
    return parameters;
}

std::vector<std::vector<double>> given_knots(const std::string& path) {
    if (extension(path) != ".json") return {read_table(path).values()};
    std::vector<std::vector<double>> knots;
    const Spline spline = read_spline(path);
    for (const KnotVector& axis : spline.axes())
        knots.emplace_back(axis.knots().begin(), axis.knots().end());
    return knots;
}

ShapeOptions shape_options(const FitFlags& flags, bool closed_given, const Samples& samples) {
    constexpr std::string_view rules[] = {"uniform", "chord", "centripetal"};
    ShapeOptions shape;
    shape.degree = flags.degree;
    if (!flags.control_points.empty())
        shape.control_points = parse_shape("--control-points", flags.control_points);
    shape.closures = closures(flags, closed_given, samples.axis_count());
    shape.parametrization =
        static_cast<Parametrization>(parse_choice("--parametrize", flags.parametrize, rules));
    if (flags.heights) shape.parametrization = Parametrization::uniform;
    shape.parameters = given_parameters(flags);
    if (flags.knots == "uniform")
        shape.placement = KnotPlacement::uniform;
    else if (flags.knots != "data")
        shape.knots = given_knots(flags.knots);
    return shape;
}

MethodOptions method_options(const FitFlags& flags) {
    MethodOptions method;
    method.name = flags.method;
    method.settings = parse_settings(flags.set);
    if (flags.initial == "zero") {
        method.initial = Initial::zero;
    } else if (flags.initial != "data") {
        method.initial = Initial::given;
        method.control = extension(flags.initial) == ".json"
                             ? read_spline(flags.initial).free_control_points()
                             : read_table(flags.initial);
    }
    return method;
}

/// `0,20,40`, or the whole numbers of a file.
std::vector<Index> index_list(std::string_view option, const std::string& text) {
    std::vector<double> numbers;
    if (text.find_first_not_of("0123456789,") != std::string::npos)
        numbers = read_table(text).values();
    else
        for (std::size_t at = 0; at <= text.size();) {
            const std::size_t end = std::min(text.find(',', at), text.size());
            numbers.push_back(parse_number(option, text.substr(at, end - at)));
            at = end + 1;
        }
    std::vector<Index> result;
    for (double x : numbers) {
        if (x != std::floor(x) || x < 0)
            throw InvalidInput(fmt::format("{}: {} is not an index", option, x));
        result.push_back(static_cast<Index>(x));
    }
    return result;
}

HoldOptions hold_options(const FitFlags& flags, const Samples& samples) {
    constexpr std::string_view shapes[] = {"convexity", "inflections"};
    HoldOptions hold;
    if (flags.interpolate == "ends")
        hold.interpolate = end_samples(samples);
    else if (!flags.interpolate.empty())
        hold.interpolate = index_list("--interpolate", flags.interpolate);
    if (!flags.preserve.empty())
        hold.preserve = parse_choice("--preserve", flags.preserve, shapes) == 0
                            ? Preserve::convexity
                            : Preserve::inflections;
    return hold;
}

ToleranceOptions tolerance_options(const FitFlags& flags, const CLI::App& fit,
                                   const Samples& samples) {
    ToleranceOptions tolerance;
    if (fit.count("--tolerance") > 0 && !(flags.tolerance > 0))
        throw InvalidInput(fmt::format("--tolerance {}: must be positive", flags.tolerance));
    if (fit.count("--tolerance") + fit.count("--tolerances") > 0 && !flags.control_points.empty())
        throw InvalidInput("--tolerance and --control-points: one of them states the size; "
                           "--max-control-points bounds a tolerance");
    tolerance.value = flags.tolerance;
    if (!flags.tolerances.empty()) tolerance.per_sample = read_table(flags.tolerances).values();
    tolerance.max_control_points = flags.max_control_points;
    const bool sized = !flags.control_points.empty() ||
                       (flags.knots != "data" && flags.knots != "uniform") ||
                       flags.method == "pia" || flags.method == "epia";
    if (!tolerance.stated() &&
        !sized) { // neither a size nor a tolerance: a thousandth of the data's size
        tolerance.value = diagonal(samples.points) / 1000;
        if (!(tolerance.value > 0)) tolerance.value = 1e-3;
    }
    if (flags.corners == "none")
        tolerance.corners = Corners::none;
    else if (flags.corners != "auto") {
        tolerance.corners = Corners::given;
        tolerance.corner_samples = index_list("--corners", flags.corners);
    }
    return tolerance;
}

StopRule stop_rule(const FitFlags& flags, const CLI::App& fit) {
    StopRule stop;
    const bool relative = fit.count("--stop-relative-gradient") > 0;
    const bool other = fit.count("--stop-gradient") + fit.count("--stop-deviation") > 0;
    stop.max_iterations = flags.max_iterations;
    stop.gradient = flags.stop_gradient;
    stop.deviation = flags.stop_deviation;
    if (relative || other) stop.relative_gradient = flags.stop_relative_gradient;
    return stop;
}

Samples samples_of(const FitFlags& flags) {
    ReadOptions options;
    if (!flags.grid.empty()) options.grid = parse_shape("--grid", flags.grid);
    options.heights = flags.heights;
    options.spacing = parse_spacing(flags.spacing);
    Samples samples = read_points(flags.points, options);
    if (!flags.weights.empty()) samples.weights = read_table(flags.weights).values();
    return samples;
}

void run(const FitFlags& flags, const CLI::App& fit_app) {
    method_entry(flags.method);
    for (const std::string& output : flags.outputs) check_output(output);
    if (!flags.summary.empty()) check_folder(flags.summary);
    Progress progress(flags.quiet ? Progress::Show::never : Progress::Show::when_slow);
    progress.say("reading " + flags.points);
    const Samples samples = samples_of(flags);
    FitOptions options;
    options.shape = shape_options(flags, fit_app.count("--closed") > 0, samples);
    options.tolerance = tolerance_options(flags, fit_app, samples);
    options.method = method_options(flags);
    options.hold = hold_options(flags, samples);
    if (!flags.moving.empty()) options.method.moving = index_list("--moving", flags.moving);
    options.stop = stop_rule(flags, fit_app);
    options.keep_history = flags.history;
    options.threads = flags.threads;
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
    for (const std::string& output : flags.outputs) {
        progress.say("writing " + output);
        write_spline(output, {result.spline, &samples, flags.points});
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
    fit->add_option("POINTS", flags->points,
                    "Points: .csv .txt .xyz .dat .npy, or - for standard input")
        ->required();
    fit->add_option("--output,-o", flags->outputs, "Write the spline: .json .svg; may be repeated")
        ->group("Output");
    fit->add_option("--summary", flags->summary, "Write the report as JSON")->group("Output");
    fit->add_flag("--history", flags->history, "Keep every iteration in the summary")
        ->group("Output");
    add_shape_flags(*fit, *flags);
    add_method_flags(*fit, *flags);
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
