#include "fit_flags.hpp"
#include "parse.hpp"
#include "spline_input.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>

namespace batten::command {

namespace {

/// Axes of the fit: a cloud's are those of its parameters, or of the plane that gives it some.
Index axis_count(const Samples& samples, const ShapeOptions& shape) {
    if (shape.parameters && shape.parameters->is_scattered()) return shape.parameters->axis_count();
    const bool cloud = samples.kind() == SampleKind::cloud && !shape.parameters;
    return cloud || shape.projection ? 2 : samples.axis_count();
}

/// `all`, axes like 0,1, or C0, C1, ... for a closed curve's seam.
void set_closures(const std::string& text, Index axes, ShapeOptions& shape) {
    if (text.empty() || text == "all" || text.starts_with("C") || text.starts_with("c")) {
        shape.closures = {Closure::closed};
        if (text.empty() || text == "all") return;
        if (axes > 1)
            throw InvalidInput(fmt::format(
                "--closed {}: the continuity at a seam is for curves; here the axes are 0 to {}",
                text, axes - 1));
        const double order = parse_number("--closed C", text.substr(1));
        if (order != std::floor(order) || order < 0 || order >= max_degree)
            throw InvalidInput(
                fmt::format("--closed {}: C0 to C{} is needed", text, max_degree - 1));
        shape.seam_continuity = static_cast<int>(order);
        return;
    }
    shape.closures.assign(static_cast<std::size_t>(axes), Closure::open);
    for (Index axis : index_list("--closed", text)) {
        if (axis >= axes)
            throw InvalidInput(fmt::format("--closed {}: the axes are 0 to {}", text, axes - 1));
        Closure& closure = shape.closures[static_cast<std::size_t>(axis)];
        if (closure == Closure::closed)
            throw InvalidInput(fmt::format("--closed {}: axis {} is named twice", text, axis));
        closure = Closure::closed;
    }
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

} // namespace

std::vector<std::vector<double>> given_knots(const std::string& path) {
    if (extension(path) != ".json") return {read_table(path).values()};
    std::vector<std::vector<double>> knots;
    const Spline spline = read({path});
    for (const KnotVector& axis : spline.axes())
        knots.emplace_back(axis.knots().begin(), axis.knots().end());
    return knots;
}

ShapeOptions shape_options(const FitFlags& flags, const CLI::App& fit, const Samples& samples) {
    constexpr std::string_view projections[] = {"xy", "xz", "yz", "plane"};
    constexpr std::string_view rules[] = {"uniform", "chord", "centripetal"};
    ShapeOptions shape;
    shape.degree = flags.degree;
    if (!flags.control_points.empty())
        shape.control_points = parse_shape("--control-points", flags.control_points);
    if (fit.count("--parametrize") > 0)
        shape.parametrization =
            static_cast<Parametrization>(parse_choice("--parametrize", flags.parametrize, rules));
    shape.parameters = given_parameters(flags);
    if (!flags.project.empty())
        shape.projection =
            static_cast<Projection>(parse_choice("--project", flags.project, projections));
    if (fit.count("--closed") > 0) set_closures(flags.closed, axis_count(samples, shape), shape);
    if (flags.knots == "uniform")
        shape.placement = KnotPlacement::uniform;
    else if (flags.knots == "data")
        shape.placement = KnotPlacement::data;
    else if (!flags.knots.empty())
        shape.knots = given_knots(flags.knots);
    return shape;
}

namespace {

MethodOptions method_options(const FitFlags& flags) {
    MethodOptions method;
    method.name = flags.method;
    method.settings = parse_settings(flags.set);
    if (flags.initial == "zero") {
        method.initial = Initial::zero;
    } else if (flags.initial != "data") {
        method.initial = Initial::given;
        if (extension(flags.initial) == ".json") {
            const Spline start = read({flags.initial});
            method.control = start.free_control_points();
            method.control_axes = start.axes();
        } else {
            method.control = read_table(flags.initial);
        }
    }
    if (!flags.before.empty())
        method.before = extension(flags.before) == ".json"
                            ? read({flags.before}).free_control_points()
                            : read_table(flags.before);
    return method;
}

/// Rows of sample, [axis,] vector.
void add_tangents(const std::string& path, TangentKind kind, const Samples& samples,
                  HoldOptions& hold) {
    const PointSet table = read_table(path);
    const Index dim = samples.dim();
    const bool with_axis = table.dim() == dim + 2;
    if (table.dim() != dim + 1 && !with_axis)
        throw InvalidInput(fmt::format("{}: rows of sample, {} coordinates are needed (or sample, "
                                       "axis, coordinates), got {} columns",
                                       path, dim, table.dim()));
    for (Index i = 0; i < table.size(); ++i) {
        const auto row = table[i];
        for (Index k = 0; k < (with_axis ? 2 : 1); ++k)
            if (table(i, k) != std::floor(table(i, k)) || table(i, k) < 0)
                throw InvalidInput(
                    fmt::format("{}: row {}: {} is not an index", path, i, table(i, k)));
        hold.tangents.push_back({.sample = static_cast<Index>(row[0]),
                                 .value = {row.end() - dim, row.end()},
                                 .axis = with_axis ? static_cast<int>(row[1]) : 0,
                                 .kind = kind});
    }
}

/// `u0=FILE`.
HeldBoundary boundary(const std::string& text) {
    const bool good = text.size() > 3 &&
                      std::string_view("uvw").find(text[0]) != std::string::npos &&
                      (text[1] == '0' || text[1] == '1') && text[2] == '=';
    if (!good)
        throw InvalidInput(
            fmt::format("--boundary {}: u0=FILE, u1=FILE, v0=FILE or v1=FILE is needed", text));
    return {.axis = text[0] - 'u',
            .end = text[1] == '0' ? AxisEnd::begin : AxisEnd::end,
            .spline = read({text.substr(3)})};
}

} // namespace

SmoothOptions smooth_options(const std::string& text, int order) {
    SmoothOptions smooth;
    smooth.wanted = !text.empty();
    smooth.order = order;
    if (text.empty() || text == "auto") return smooth;
    smooth.lambda = parse_number("--smooth", text);
    if (!(smooth.lambda > 0) || !std::isfinite(smooth.lambda))
        throw InvalidInput(fmt::format("--smooth {}: auto or a positive number is needed", text));
    return smooth;
}

namespace {

HoldOptions hold_options(const FitFlags& flags, const Samples& samples) {
    constexpr std::string_view shapes[] = {"convexity", "inflections"};
    HoldOptions hold;
    if (flags.interpolate == "ends")
        hold.interpolate = end_samples(samples);
    else if (!flags.interpolate.empty())
        hold.interpolate = index_list("--interpolate", flags.interpolate);
    if (!flags.tangents.empty())
        add_tangents(flags.tangents, TangentKind::direction, samples, hold);
    if (!flags.derivatives.empty())
        add_tangents(flags.derivatives, TangentKind::derivative, samples, hold);
    for (const std::string& text : flags.boundaries) hold.boundaries.push_back(boundary(text));
    if (!flags.preserve.empty())
        hold.preserve = parse_choice("--preserve", flags.preserve, shapes) == 0
                            ? Preserve::convexity
                            : Preserve::inflections;
    return hold;
}

ToleranceOptions tolerance_options(const FitFlags& flags, const CLI::App& fit) {
    ToleranceOptions tolerance;
    if (fit.count("--tolerance") + fit.count("--tolerances") > 0 && !flags.control_points.empty())
        throw InvalidInput("--tolerance and --control-points: one of them states the size; "
                           "--max-control-points bounds a tolerance");
    tolerance.value = flags.tolerance;
    if (!flags.tolerances.empty()) tolerance.per_sample = read_table(flags.tolerances).values();
    tolerance.max_control_points = flags.max_control_points;
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

} // namespace

namespace {

/// Throws InvalidInput where the samples take more bytes than --memory allows; -1 of them are not
/// counted yet.
void check_memory_flag(const FitFlags& flags, Index allowed, Index samples, Index dim) {
    const double needed = static_cast<double>(samples) * static_cast<double>(dim) * sizeof(double);
    if (needed > static_cast<double>(allowed))
        throw InvalidInput(fmt::format("--memory {}: the {} samples of {} take {:.3g} MB",
                                       flags.memory, samples, flags.points, needed / 1e6));
}

} // namespace

Samples samples_of(const FitFlags& flags, const ReadObserver& observer) {
    ReadOptions options;
    if (!flags.grid.empty()) options.grid = parse_shape("--grid", flags.grid);
    options.heights = flags.heights;
    options.spacing = parse_spacing(flags.spacing);
    const Index allowed = flags.memory.empty() ? std::numeric_limits<Index>::max()
                                               : parse_bytes("--memory", flags.memory);
    if (!flags.memory.empty() && std::filesystem::is_regular_file(flags.points)) {
        const auto source = open_points(flags.points, options);
        check_memory_flag(flags, allowed, source->size(), source->dim());
    }
    options.observer = observer;
    Samples samples = read_points(flags.points, options);
    check_memory_flag(flags, allowed, samples.size(), samples.dim());
    if (!flags.weights.empty()) samples.weights = read_table(flags.weights).values();
    return samples;
}

namespace {

/// Throws InvalidInput for flags that say nothing, or contradict each other, beside the others.
void check_together(const FitFlags& flags, const CLI::App& fit) {
    const auto given = [&](const char* name) { return fit.count(name) > 0; };
    const auto refuse = [](const char* words) { throw InvalidInput(words); };
    if (given("--smooth-order") && !given("--smooth")) refuse("--smooth-order: it needs --smooth");
    if (given("--spacing") && !flags.heights) refuse("--spacing: it is for --heights");
    if (flags.history && flags.summary.empty() && flags.report.empty())
        refuse("--history: it needs --summary or --report");
}

} // namespace

FitOptions options_of(const FitFlags& flags, const CLI::App& fit, const Samples& samples) {
    check_together(flags, fit);
    FitOptions options;
    options.shape = shape_options(flags, fit, samples);
    options.tolerance = tolerance_options(flags, fit);
    options.method = method_options(flags);
    options.hold = hold_options(flags, samples);
    options.smooth = smooth_options(flags.smooth, flags.smooth_order);
    options.outliers = flags.robust ? Outliers::set_aside : Outliers::count;
    if (!flags.moving.empty()) options.method.moving = index_list("--moving", flags.moving);
    options.stop = stop_rule(flags, fit);
    options.keep_history = flags.history;
    options.threads = flags.threads;
    return options;
}

} // namespace batten::command
