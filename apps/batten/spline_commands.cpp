#include "commands.hpp"
#include "export_flags.hpp"
#include "parse.hpp"
#include "spline_input.hpp"
#include "system_files.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/output_set.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/svg.hpp>
#include <batten/io/system_file.hpp>
#include <batten/measure/deviation.hpp>

#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace batten::command {

namespace {

/// `count` parameters evenly over an axis's domain.
std::vector<double> even_parameters(const KnotVector& axis, Index count) {
    std::vector<double> t;
    t.reserve(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i)
        t.push_back(count == 1 ? axis.begin()
                               : axis.begin() + axis.length() * static_cast<double>(i) /
                                                    static_cast<double>(count - 1));
    return t;
}

/// Throws InvalidInput for a parameter outside an open axis's domain.
void check_domain(const Spline& spline, const PointSet& table, const std::string& path) {
    for (Index i = 0; i < table.size(); ++i)
        for (Index k = 0; k < std::min(table.dim(), spline.axis_count()); ++k) {
            const KnotVector& axis = spline.axis(k);
            if (!axis.closed() && !(table(i, k) >= axis.begin() && table(i, k) <= axis.end()))
                throw InvalidInput(
                    fmt::format("{}: row {}: parameter {} is outside the domain [{}, "
                                "{}] of axis {}",
                                path, i, table(i, k), axis.begin(), axis.end(), k));
        }
}

/// The points in the spline's space: points of the plane get a zero third coordinate beside a
/// spline of a CAD file.
Samples in_space_of(const Spline& spline, Samples samples) {
    if (spline.dim() != 3 || samples.dim() != 2) return samples;
    PointSet points(samples.size(), 3);
    for (Index i = 0; i < samples.size(); ++i)
        for (Index d = 0; d < 2; ++d) points(i, d) = samples.points(i, d);
    samples.points = Points(std::move(points));
    return samples;
}

void evaluate_spline(const SplineInput& input, const std::string& samples,
                     const std::string& parameters, const std::string& output,
                     std::vector<int> orders) {
    if (samples.empty() == parameters.empty())
        throw InvalidInput("evaluate: one of --samples and --parameters is needed");
    std::vector<FileUse> inputs{{input.path, "the spline"}};
    if (!parameters.empty()) inputs.push_back({parameters, "--parameters"});
    check_outputs(std::array{FileUse{output, "--output"}}, inputs);
    const Spline spline = read(input);
    if (orders.size() == 1) orders.resize(static_cast<std::size_t>(spline.axis_count()), 0);
    if (!parameters.empty()) {
        const PointSet table = read_table(parameters);
        check_domain(spline, table, parameters);
        return write_points(output, evaluate(spline, table, orders));
    }
    std::vector<Index> counts = parse_shape("--samples", samples);
    if (counts.size() == 1) counts.resize(static_cast<std::size_t>(spline.axis_count()), counts[0]);
    if (static_cast<Index>(counts.size()) != spline.axis_count())
        throw InvalidInput(
            fmt::format("--samples {}: the spline has {} axes", samples, spline.axis_count()));
    check_room(output, counts, spline.dim());
    std::vector<std::vector<double>> axes;
    for (std::size_t k = 0; k < counts.size(); ++k)
        axes.push_back(even_parameters(spline.axes()[k], counts[k]));
    write_points(output, evaluate_grid(spline, axes, orders),
                 counts.size() > 1 ? counts : std::vector<Index>{});
}

/// How a file of points beside a spline is read.
struct PointFlags {
    std::string points;
    bool heights = false;
    std::string spacing = "1,1";
};

void add_point_flags(CLI::App& app, PointFlags& flags) {
    app.add_flag("--heights", flags.heights,
                 "The points are a table of heights over a regular grid");
    app.add_option("--spacing", flags.spacing, "Grid distances DX,DY of --heights")
        ->capture_default_str();
}

Samples points_of(const PointFlags& flags) {
    ReadOptions options;
    options.heights = flags.heights;
    options.spacing = parse_spacing(flags.spacing);
    return read_points(flags.points, options);
}

void compare(const SplineInput& input, const PointFlags& points) {
    const Spline spline = read(input);
    const Samples samples = in_space_of(spline, points_of(points));
    const Deviation d =
        summarise(closest_distances(spline, samples.points), DeviationKind::distance);
    fmt::print("{} points, distance to the closest point of the spline: largest {:.6g} at sample "
               "{}, rms {:.6g}\n",
               samples.size(), d.maximum, d.worst_sample, d.rms);
}

void describe_spline(const std::string& path, const Spline& spline) {
    const PointSet box = bounding_box(spline.control_points());
    fmt::print("{}: B-spline {} in dimension {}, {} control points\n", path, kind_name(spline),
               spline.dim(), fmt::join(spline.control_shape(), "x"));
    for (Index k = 0; k < spline.axis_count(); ++k) {
        const KnotVector& axis = spline.axis(k);
        fmt::print("  axis {}: degree {}, {}, {} knots, domain [{:.6g}, {:.6g}], {} pieces\n", k,
                   axis.degree(), axis.closed() ? "closed" : "open", axis.knots().size(),
                   axis.begin(), axis.end(), axis.breakpoints().size() - 1);
    }
    fmt::print("  control points from ({:.6g}) to ({:.6g})\n", fmt::join(box[0], ", "),
               fmt::join(box[1], ", "));
}

void describe_splines(const std::string& path) {
    const SplineFile file = read_splines(path);
    const std::size_t count = file.splines.size();
    for (std::size_t k = 0; k < count; ++k) {
        if (count > 1) fmt::print("entity {} of {}, ", k + 1, count);
        describe_spline(path, file.splines[k]);
    }
    for (const std::string& note : file.notes) fmt::print("  {}\n", note);
}

void describe_points(const std::string& path) {
    const Samples samples = read_points(path);
    const PointSet box = bounding_box(samples.points);
    fmt::print("{}: {} points in dimension {}{}\n", path, samples.size(), samples.dim(),
               samples.grid.empty() ? ""
                                    : fmt::format(", a grid {}", fmt::join(samples.grid, "x")));
    fmt::print("  from ({:.6g}) to ({:.6g}), diagonal {:.6g}\n", fmt::join(box[0], ", "),
               fmt::join(box[1], ", "), diagonal(samples.points));
    Index repeated = 0;
    for (Index i = 1; i < samples.size(); ++i)
        repeated += std::ranges::equal(samples.points[i], samples.points[i - 1]) ? 1 : 0;
    if (repeated > 0) fmt::print("  {} identical consecutive points\n", repeated);
    for (const std::string& note : samples.notes) fmt::print("  {}\n", note);
}

void plot(const SplineInput& input, const PointFlags& points, const std::string& output,
          bool comb) {
    if (extension(output) != ".svg" && !is_stream(output))
        throw InvalidInput(fmt::format("plot: {}: a picture .svg is written", output));
    std::vector<FileUse> inputs{{input.path, "the spline"}};
    if (!points.points.empty()) inputs.push_back({points.points, "the points"});
    check_outputs(std::array{FileUse{output, "--output"}}, inputs);
    const Spline spline = read(input);
    Samples samples;
    std::vector<double> distances;
    Scene scene{.spline = spline,
                .title = std::filesystem::path(input.path).stem().string(),
                .curvature_comb = comb};
    if (!points.points.empty()) {
        samples = in_space_of(spline, points_of(points));
        scene.samples = &samples;
        distances = closest_distances(spline, samples.points);
        scene.deviations = &distances;
    }
    write_file(output, svg_picture(scene));
}

} // namespace

void add_evaluate(CLI::App& app) {
    struct Flags {
        SplineInput spline;
        std::string samples, parameters, output = "-";
        std::vector<int> orders;
    };
    CLI::App* sub = app.add_subcommand("evaluate", "Points of a spline");
    auto flags = std::make_shared<Flags>();
    add_spline_input(*sub, flags->spline);
    sub->add_option("--samples", flags->samples,
                    "Points per axis, evenly over the domain: 200 or 40x60");
    sub->add_option("--parameters", flags->parameters, "File of parameters, one row per point");
    sub->add_option("--derivative", flags->orders, "Derivative orders, one per axis: 1 or 1,0")
        ->delimiter(',');
    sub->add_option("--output,-o", flags->output, "Points: .csv .txt .xyz .dat .npy")
        ->capture_default_str();
    sub->footer("Example:\n  batten evaluate part.json --samples 500 -o points.csv");
    sub->callback([flags] {
        evaluate_spline(flags->spline, flags->samples, flags->parameters, flags->output,
                        flags->orders);
    });
}

void add_compare(CLI::App& app) {
    struct Flags {
        SplineInput spline;
        PointFlags points;
    };
    CLI::App* sub = app.add_subcommand("compare", "Distances of points from a spline");
    auto flags = std::make_shared<Flags>();
    add_spline_input(*sub, flags->spline);
    sub->add_option("POINTS", flags->points.points, "Points")->required();
    add_point_flags(*sub, flags->points);
    sub->footer("Example:\n  batten compare part.json measured.csv");
    sub->callback([flags] { compare(flags->spline, flags->points); });
}

void add_info(CLI::App& app) {
    CLI::App* sub = app.add_subcommand("info", "What is in a file");
    auto file = std::make_shared<std::string>();
    sub->add_option("FILE", *file, "A spline, a saved system or points")->required();
    sub->footer("Example:\n  batten info part.json");
    sub->callback([file] {
        if (extension(*file) == ".sys")
            fmt::print("{}: {}\n", *file, system_words(load_system(*file)));
        else
            is_spline_file(*file) ? describe_splines(*file) : describe_points(*file);
    });
}

void add_plot(CLI::App& app) {
    struct Flags {
        SplineInput spline;
        std::string output = "-";
        PointFlags points;
        bool comb = false;
    };
    CLI::App* sub =
        app.add_subcommand("plot", "A picture of a spline, and of points beside it, as SVG");
    auto flags = std::make_shared<Flags>();
    add_spline_input(*sub, flags->spline);
    sub->add_option("POINTS", flags->points.points, "Points, coloured by their distance from it");
    add_point_flags(*sub, flags->points);
    sub->add_option("--output,-o", flags->output, "Picture .svg, - for standard output")
        ->capture_default_str();
    sub->add_flag("--comb", flags->comb, "The curvature comb of a planar curve");
    sub->footer("Example:\n  batten plot part.json measured.csv -o part.svg");
    sub->callback([flags] { plot(flags->spline, flags->points, flags->output, flags->comb); });
}

} // namespace batten::command
