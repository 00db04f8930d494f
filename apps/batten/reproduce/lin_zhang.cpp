#include "dominant_columns.hpp"
#include "papers.hpp"

#include <batten/core/stopwatch.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/svg.hpp>
#include <batten/samples/generate.hpp>

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace batten::command {

namespace {

/// Samples, what they stand in for the paper's with, and the paper's box [Table 3], which they are
/// stretched into so that lengths compare: by one factor (a curve), or each coordinate by its own.
struct Model {
    Samples samples;
    std::string why;
};

using Box = std::vector<std::array<double, 2>>;

const Box box_of_figure_2{{1.5786, 6.3836}, {1.0252, 8.8742}};
const Box box_of_the_glyph{{0.1313, 0.9454}, {0.0786, 0.9172}};
const Box box_of_the_patch{{0.0129, 0.6164}, {0.0048, 0.6983}, {0.0382, 0.9587}};

/// Samples of the size of the box: a curve as it is, of the same diagonal; a patch filling it.
Samples in_box(Samples samples, const Box& box) {
    const PointSet own = bounding_box(samples.points);
    PointSet corners(2, own.dim());
    for (Index d = 0; d < own.dim(); ++d)
        for (Index end : {0, 1})
            corners(end, d) = box[static_cast<std::size_t>(d)][static_cast<std::size_t>(end)];
    const double alike = diagonal(Points(corners)) / diagonal(samples.points);
    PointSet moved(samples.points);
    for (Index i = 0; i < moved.size(); ++i)
        for (Index d = 0; d < moved.dim(); ++d) {
            const double factor = samples.grid.empty()
                                      ? alike
                                      : (corners(1, d) - corners(0, d)) / (own(1, d) - own(0, d));
            moved(i, d) = corners(0, d) + factor * (moved(i, d) - own(0, d));
        }
    samples.points = Points(std::move(moved));
    return samples;
}

Model glyph(const Workshop& workshop) {
    if (auto real = workshop.real("glyph273.csv"))
        return {in_box(std::move(*real), box_of_the_glyph),
                "glyph273.csv, a letter G of 273 points, at the paper's size"};
    return {in_box(generate("letter"), box_of_the_glyph),
            "a built-in letter G of 269 points, at the paper's size"};
}

/// So many of a sequence's samples, evenly by index.
Samples thinned(const Samples& samples, Index count) {
    PointSet some(count, samples.dim());
    for (Index i = 0; i < count; ++i)
        std::ranges::copy(samples.points[i * (samples.size() - 1) / (count - 1)], some[i].begin());
    Samples result;
    result.points = Points(std::move(some));
    return result;
}

/// 121 x 161 samples from the middle of a terrain, else of the peaks.
Model patch(const Workshop& workshop) {
    constexpr std::string_view file = "terrain344x403.npy";
    constexpr Index rows = 121;
    constexpr Index columns = 161;
    if (!workshop.has(file))
        return {in_box(generate("peaks", {rows, columns}), box_of_the_patch),
                "peaks, 121 x 161 samples, in the paper's box"};
    const Samples terrain = read_points(workshop.data / file, {.grid = {}, .heights = true});
    PointSet window(rows * columns, terrain.dim());
    const Index top = (terrain.grid[0] - rows) / 2;
    const Index left = (terrain.grid[1] - columns) / 2;
    for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < columns; ++j)
            std::ranges::copy(terrain.points[(top + i) * terrain.grid[1] + left + j],
                              window[i * columns + j].begin());
    Samples samples;
    samples.points = Points(std::move(window));
    samples.grid = {rows, columns};
    return {in_box(std::move(samples), box_of_the_patch),
            "a window of a terrain, rougher than a scan, in the paper's box"};
}

FitOptions epia_options(Index iterations, double deviation) {
    FitOptions options;
    options.method.name = "epia";
    options.stop = {.max_iterations = iterations, .relative_gradient = 0, .deviation = deviation};
    options.keep_history = true;
    return options;
}

/// Draws the spline as it stood after these iterations, each with its own control points.
void draw_steps(const Model& model, FitOptions options, Workshop& workshop, const std::string& stem,
                const std::vector<Index>& steps) {
    for (Index step : steps) {
        options.stop.max_iterations = step;
        const FitResult then = fit(model.samples, options);
        workshop.drawings.push_back(
            {fmt::format("{}_step{}.svg", stem, step),
             svg_picture({then.spline, &model.samples, fmt::format("step {}", step)})});
    }
}

/// Fig. 2: an interpolated sample of 43, by 13 control points.
Table figure_2(Workshop& workshop) {
    Model model = glyph(workshop);
    model.samples = in_box(thinned(model.samples, 43), box_of_figure_2);
    FitOptions options = epia_options(10, 0);
    options.shape.control_points = {13};
    options.hold.interpolate = {21};
    draw_steps(model, options, workshop, "epia_fig2", {0, 10});
    const FitReport after = fit(model.samples, options).report;
    options.stop.max_iterations = 0;
    const FitReport before = fit(model.samples, options).report;
    return {"Figure 2, one of 43 samples interpolated",
            {{"control points", "13", static_cast<double>(after.control_shape[0])},
             {"its error at the start", "0.1265", before.constraint_error},
             {"its error after 10 iterations", "0.0097", after.constraint_error}},
            Data::stand_in,
            "43 points of " + model.why,
            "epia_fig2_step*.svg"};
}

/// A line of Table 1: iterations, control points, e_d.
struct Printed {
    Index iterations;
    const char *controls, *deviation;
};

Table table_1(double eta, std::string_view figure, const std::vector<Printed>& printed,
              Workshop& workshop) {
    const Model model = glyph(workshop);
    FitOptions options = epia_options(300, 0.0035);
    options.method.settings["eta"] = eta;
    const std::string stem = fmt::format("epia_letter_{}", eta);
    const FitReport report = drawn_fit(model.samples, options, workshop, stem, {}).report;
    Table table{fmt::format("Table 1 and {}, eta {}", figure, eta),
                {},
                Data::stand_in,
                model.why,
                stem + "_*.svg"};
    std::vector<Index> steps;
    for (const auto& [iterations, controls, deviation] : printed) {
        const auto at = std::min(static_cast<std::size_t>(iterations), report.history.size() - 1);
        const HistoryEntry& entry = report.history[at];
        table.rows.push_back({fmt::format("control points after {} iterations", iterations),
                              controls, static_cast<double>(entry.control_points)});
        table.rows.push_back(
            {fmt::format("e_d after {} iterations", iterations), deviation, entry.max_deviation});
        steps.push_back(iterations);
    }
    table.rows.push_back({"iterations to e_d <= 0.0035",
                          fmt::format("{}", printed.back().iterations),
                          static_cast<double>(report.iterations)});
    table.rows.push_back({"control points then", printed.back().controls,
                          static_cast<double>(report.control_shape[0])});
    draw_steps(model, options, workshop, stem, steps);
    return table;
}

void add_patch_rows(Table& table, const char* method, const FitReport& report,
                    const std::vector<const char*>& printed, const char* when) {
    table.rows.push_back({fmt::format("{}: control points along u, {}", method, when), printed[0],
                          static_cast<double>(report.control_shape[0])});
    table.rows.push_back({fmt::format("{}: control points along v, {}", method, when), printed[1],
                          static_cast<double>(report.control_shape[1])});
    table.rows.push_back(
        {fmt::format("{}: e_d, {}", method, when), printed[2], report.deviation.maximum});
}

/// Table 2 and Fig. 6: EPIA beside repeated least squares.
Table table_2(Workshop& workshop) {
    const Model model = patch(workshop);
    constexpr double deviation = 0.0025;
    FitOptions options = epia_options(0, deviation);
    const FitResult start = fit(model.samples, options);
    options.stop.max_iterations = 100;
    Stopwatch watch;
    const FitResult end = fit(model.samples, options);
    const double seconds = watch.lap();
    const RepeatedLeastSquares other = repeated_least_squares(model.samples, {20, 31}, 100);
    Table table{"Table 2 and Fig. 6, a patch", {}, Data::stand_in, model.why, "epia_fig6_*.svg"};
    add_patch_rows(table, "EPIA", start.report, {"31", "66", "0.053347"}, "start");
    add_patch_rows(table, "EPIA", end.report, {"68", "90", "0.002576"}, "100 iterations");
    table.rows.push_back({"EPIA: seconds", "4.6903", seconds, true});
    add_patch_rows(table, "[27]", other.first.report, {"20", "31", "0.021707"}, "start");
    add_patch_rows(table, "[27]", other.last.report, {"87", "67", "0.002743"}, "100 iterations");
    table.rows.push_back({"[27]: seconds", "10.7226", other.seconds, true});
    for (const auto& [name, result] : {std::pair("epia_start", &start),
                                       {"epia_100", &end},
                                       {"columns_start", &other.first},
                                       {"columns_100", &other.last}})
        workshop.drawings.push_back(
            {fmt::format("epia_fig6_{}.svg", name), svg_picture({result->spline, nullptr, name})});
    return table;
}

/// Table 3: the curves are stretched by one factor, so their proportions are their own.
Table table_3(const Workshop& workshop) {
    const Model model = glyph(workshop);
    const PointSet box = bounding_box(model.samples.points);
    return {
        "Table 3, the glyph's box",
        {{"width", "0.8141", box(1, 0) - box(0, 0)}, {"height", "0.8386", box(1, 1) - box(0, 1)}},
        Data::stand_in,
        model.why};
}

} // namespace

std::vector<Table> lin_zhang(Workshop& workshop) {
    return {figure_2(workshop),
            table_1(0.6, "Fig. 3",
                    {{0, "37", "0.074793"},
                     {15, "42", "0.016525"},
                     {50, "59", "0.005326"},
                     {70, "66", "0.003501"}},
                    workshop),
            table_1(0.9, "Fig. 4",
                    {{0, "83", "0.073984"},
                     {10, "85", "0.014109"},
                     {20, "87", "0.009085"},
                     {40, "92", "0.003494"}},
                    workshop),
            table_2(workshop), table_3(workshop)};
}

} // namespace batten::command
