#include "convergence_plot.hpp"
#include "papers.hpp"

#include <batten/samples/generate.hpp>
#include <batten/shape/polygon.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <random>

namespace batten::command {

namespace {

std::vector<Index> evenly(Index count, Index samples) {
    std::vector<Index> list;
    for (Index i = 0; i < count; ++i) list.push_back(i * (samples - 1) / (count - 1));
    return list;
}

std::vector<Index> every(Index step, Index samples) {
    std::vector<Index> list;
    for (Index i = 0; i < samples; i += step) list.push_back(i);
    return list;
}

FitOptions clspia_options(std::vector<Index> control, std::vector<Index> exact) {
    FitOptions options;
    options.shape.control_points = std::move(control);
    options.hold.interpolate = std::move(exact);
    options.method = {.name = "clspia", .settings = {{"warm_start", 6}}};
    options.stop = {.max_iterations = 100000, .relative_gradient = 1e-12};
    options.keep_history = true;
    return options;
}

/// One factor for all multipliers and one for all control points, 1 / beta_max and 1 / gamma_max,
/// where batten by itself has better ones.
void as_printed(const Samples& samples, FitOptions& options) {
    FitOptions asked = options;
    asked.method.settings["row_sums"] = 0;
    asked.stop.max_iterations = 0;
    const Settings found = fit(samples, asked).report.settings;
    options.method.settings["mu"] = 1 / found.at("beta_max");
    options.method.settings["mu_1"] = found.at("gamma_max");
}

/// A line of Table 1 or 2: E_k is the mean square of what the exact samples lack.
struct Example {
    std::string name;
    const char* file;           ///< the authors' data
    const char* built_in;       ///< a curve that stands in
    std::vector<Index> samples; ///< of that
    std::vector<Index> control;
    Index exact_step;
    std::vector<const char*> printed; ///< E_k at `steps`, then E and the error
};

Table line(const Example& example, const std::vector<std::size_t>& steps, const char* kind,
           Workshop& workshop, std::vector<Series>& errors) {
    const std::optional<Samples> real = workshop.real(example.file);
    const Samples samples = real ? *real : generate(example.built_in, example.samples);
    FitOptions options = clspia_options(example.control, every(example.exact_step, samples.size()));
    const auto exact = static_cast<double>(options.hold.interpolate.size());
    as_printed(samples, options);
    const std::string stem = fmt::format("{}{}", kind, errors.size() + 1);
    const FitResult result = drawn_fit(samples, options, workshop, stem, {0, 1, 3, 7});
    Series series{example.name.substr(example.name.find(", ") + 2), {}}; // behind "Table 1, "
    for (const HistoryEntry& h : result.report.history)
        series.values.push_back(h.constraint_error / exact);
    Table table{example.name, {}};
    for (std::size_t k = 0; k < steps.size(); ++k)
        table.rows.push_back({fmt::format("E_{}", steps[k]), example.printed[k],
                              series.values[std::min(steps[k], series.values.size() - 1)]});
    const double rms = result.report.deviation.rms;
    const auto count = static_cast<double>(samples.size());
    table.rows.push_back({"E", example.printed[steps.size()], series.values.back(), true});
    table.rows.push_back({"error, mean square of the approximated samples",
                          example.printed[steps.size() + 1], rms * rms * count / (count - exact)});
    table.rows.push_back(
        {"iterations to 1e-12", "", static_cast<double>(result.report.iterations)});
    table.pictures = stem + "_*.svg";
    if (!real) {
        table.data = Data::stand_in;
        table.why =
            fmt::format("{}, {} samples", example.built_in, fmt::join(example.samples, " x "));
    }
    errors.push_back(std::move(series));
    return table;
}

void table_1(Workshop& workshop, std::vector<Table>& tables) {
    const std::vector<Example> examples{
        {"Table 1, Ex 1, Fig. 3",
         "glyph577.csv",
         "letter",
         {577},
         {55},
         50,
         {"1.5258e-05", "8.1082e-06", "6.7438e-06", "4.6532e-06", "5.2012e-22", "1.5221e-05"}},
        {"Table 1, Ex 2, Fig. 4",
         "",
         "rose",
         {370},
         {30},
         30,
         {"1.9675e-05", "6.2619e-06", "4.8687e-06", "2.4544e-06", "1.8556e-21", "1.2134e-05"}},
        {"Table 1, Ex 3, Fig. 5",
         "profile205.csv",
         "naca2412",
         {205},
         {20},
         20,
         {"5.451e-05", "1.3895e-05", "1.3243e-05", "1e-05", "1.7835e-21", "2.2165e-05"}},
        {"Table 1, Ex 4, Fig. 6",
         "",
         "letter",
         {210},
         {37},
         20,
         {"0.0005", "0.00055", "5.1667e-04", "4.8333e-04", "2.9683e-21", "1.9265e-04"}},
        {"Table 1, Ex 5, Fig. 7",
         "",
         "rose",
         {210},
         {22},
         20,
         {"0.00038", "0.00035", "0.00036", "0.00031", "2.2077e-21", "4.220e-4"}},
        {"Table 1, Ex 6, Fig. 2",
         "",
         "letter",
         {370},
         {50},
         20,
         {"8.4211e-05", "6.8421e-05", "5.2632e-05", "3.1638e-05", "7.6653e-22", "5.0622e-05"}},
    };
    std::vector<Series> errors;
    for (const Example& example : examples)
        tables.push_back(line(example, {0, 1, 3, 7}, "clspia_example", workshop, errors));
    workshop.drawings.push_back(
        {"clspia_fig8.svg", convergence_plot("Fig. 8", "E_k of the six curves", errors)});
    tables.push_back({"Fig. 8", {}, Data::stand_in, "as in Table 1", "clspia_fig8.svg"});
}

/// Two surfaces with 60 exact samples each; the paper's are not public.
void table_2(Workshop& workshop, std::vector<Table>& tables) {
    const std::vector<Example> examples{
        {"Table 2, surface 1, Fig. 12",
         "",
         "peaks",
         {101, 101},
         {13, 13},
         173,
         {"3.6963e-05", "4.5548e-06", "2.7893e-06", "1.9812e-06", "5.8185e-07", "1.6472e-33",
          "3.6864e-07"}},
        {"Table 2, surface 2, Fig. 13",
         "",
         "torus",
         {205, 61},
         {35, 30},
         212,
         {"6.9578e-05", "6.7447e-05", "7.5758e-05", "6.0697e-06", "3.3012e-06", "9.9529e-23",
          "1.645e-07"}},
    };
    std::vector<Series> errors;
    for (const Example& example : examples)
        tables.push_back(line(example, {0, 1, 3, 7, 20}, "clspia_surface", workshop, errors));
    workshop.drawings.push_back(
        {"clspia_fig14.svg", convergence_plot("Fig. 14", "E_k of the two surfaces", errors)});
    tables.push_back({"Fig. 14", {}, Data::stand_in, "as in Table 2", "clspia_fig14.svg"});
}

constexpr Index curve_samples = 370; // of Figs. 9 to 11

/// As many exact samples as control points: what the others are does not matter.
Table figure_9(Workshop& workshop) {
    const Samples curve = generate("rose", {curve_samples});
    FitOptions options = clspia_options({35}, evenly(35, curve_samples));
    options.shape.parameters = parametrize(curve, Parametrization::chord, {Closure::open});
    const FitResult before = drawn_fit(curve, options, workshop, "clspia_fig9a", {});
    PointSet moved(curve.points);
    std::mt19937_64 random(9);
    std::normal_distribution<double> noise(0, 0.02);
    for (Index i = 0; i < moved.size(); ++i)
        if (std::ranges::count(options.hold.interpolate, i) == 0)
            for (double& x : moved[i]) x += noise(random);
    const FitResult after =
        drawn_fit({.points = Points(std::move(moved))}, options, workshop, "clspia_fig9b", {});
    double furthest = 0;
    for (Index i = 0; i < before.spline.control_points().size(); ++i)
        furthest = std::max(furthest, distance(before.spline.control_points()[i],
                                               after.spline.control_points()[i]));
    return {"Fig. 9, approximated samples moved by 0.02",
            {{"largest move of a control point", "", furthest}},
            Data::stand_in,
            "rose, 370 samples",
            "clspia_fig9a_*.svg, clspia_fig9b_*.svg"};
}

/// More control points, more exact samples; without any, LSPIA (Fig. 11).
std::vector<Table> figures_10_and_11(Workshop& workshop) {
    const Samples curve = generate("rose", {curve_samples});
    Table ten{"Fig. 10", {}, Data::stand_in, "rose, 370 samples", "clspia_fig10*.svg"};
    Table eleven{"Fig. 11",
                 {},
                 Data::stand_in,
                 "rose, 370 samples",
                 "clspia_fig10d*.svg, clspia_fig10f*.svg"};
    const struct {
        const char* panel;
        Index control, exact;
    } panels[]{{"a", 25, 15}, {"b", 35, 15}, {"c", 45, 15},
               {"d", 35, 0},  {"e", 35, 10}, {"f", 35, 15}};
    for (const auto& [panel, control, exact] : panels) {
        FitOptions options = clspia_options({control}, {});
        if (exact > 0)
            options.hold.interpolate = evenly(exact, curve_samples);
        else
            options.method = {.name = "lspia"};
        const FitReport report =
            drawn_fit(curve, options, workshop, fmt::format("clspia_fig10{}", panel), {}).report;
        const Row row{fmt::format("{} control points, {} exact: rms", control, exact), "",
                      report.deviation.rms};
        ten.rows.push_back(row);
        if (*panel == 'd' || *panel == 'f') eleven.rows.push_back(row);
    }
    return {ten, eleven};
}

Table figure_15(Workshop& workshop) {
    FitOptions options = clspia_options({100}, evenly(40, 10001));
    const FitReport report =
        drawn_fit(generate("rose", {10001}), options, workshop, "clspia_fig15", {}).report;
    return {"Fig. 15, 10001 samples, 40 exact",
            {{"iterations to 1e-12", "", static_cast<double>(report.iterations)},
             {"largest deviation", "", report.deviation.maximum}},
            Data::stand_in,
            "rose",
            "clspia_fig15_*.svg"};
}

/// Few control points for the nose of an airfoil: the fit gains inflections that its start has not.
Table figure_17(Workshop& workshop) {
    const Samples airfoil = generate("naca2412");
    FitOptions options = clspia_options({20}, {0, airfoil.size() - 1});
    options.method.settings.clear();
    options.stop = {.max_iterations = 5000};
    Table table{"Fig. 17, inflections of the control polygon",
                {},
                Data::stand_in,
                "naca2412, 201 samples",
                "clspia_fig17*.svg"};
    const auto row = [&](const char* words, const char* stem) {
        const FitResult result = drawn_fit(airfoil, options, workshop, stem, {});
        const Index count =
            inflection_count(result.spline.control_points(), Closure::open, exactly);
        table.rows.push_back({words, "", static_cast<double>(count)});
        return result.report;
    };
    const FitReport free = row("before: no shape kept", "clspia_fig17a");
    options.hold.preserve = Preserve::inflections;
    const FitReport kept = row("after: kept by whole lines", "clspia_fig17b");
    options.method.settings = {{"rays", 1}};
    row("kept by the rays as printed", "clspia_fig17c");
    table.rows.push_back(
        {"of the initial polygon", "", static_cast<double>(kept.allowed_inflections)});
    table.rows.push_back({"rms before", "", free.deviation.rms});
    table.rows.push_back({"rms after", "", kept.deviation.rms});
    return table;
}

} // namespace

std::vector<Table> chang_ma_deng(Workshop& workshop) {
    std::vector<Table> tables;
    table_1(workshop, tables);
    table_2(workshop, tables);
    tables.push_back(figure_9(workshop));
    for (Table& table : figures_10_and_11(workshop)) tables.push_back(std::move(table));
    tables.push_back(figure_15(workshop));
    tables.push_back(figure_17(workshop));
    return tables;
}

} // namespace batten::command
