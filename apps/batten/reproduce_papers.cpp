#include "reproduce.hpp"

#include <batten/fit/fit.hpp>
#include <batten/io/svg.hpp>
#include <batten/samples/generate.hpp>
#include <batten/shape/polygon.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <numbers>
#include <random>

namespace batten::command {

namespace {

constexpr double printed_digits = 1e-12; // accuracy of the eigenvalues behind the printed weights

/// Runs a fit with history, draws the history, the limit with its curvature comb, and pictures of
/// the steps asked for.
FitResult figures(const Samples& samples, FitOptions options, Drawings& drawings,
                  const std::string& stem, const std::vector<Index>& steps) {
    std::map<Index, PointSet> kept;
    options.keep_history = true;
    options.observer = [&](const Iteration& now) {
        if (std::ranges::count(steps, now.number) > 0) kept[now.number] = now.control;
        return Continue::yes;
    };
    FitResult result = fit(samples, options);
    std::string csv = "iteration,gradient_norm,largest_move,max_deviation,constraint_error\n";
    for (const HistoryEntry& h : result.report.history)
        csv += fmt::format("{},{},{},{},{}\n", h.iteration, h.gradient_norm, h.largest_move,
                           h.max_deviation, h.constraint_error);
    drawings.push_back({stem + "_history.csv", csv});
    if (samples.dim() != 2) return result;
    for (const auto& [step, control] : kept) {
        if (control.size() != result.spline.axis(0).free_count())
            continue; // before a knot was inserted
        const Spline spline = Spline::from_free(result.spline.axes(), control);
        drawings.push_back({fmt::format("{}_step{}.svg", stem, step),
                            svg_picture({spline, &samples, fmt::format("step {}", step)})});
    }
    drawings.push_back({stem + "_limit.svg", svg_picture({result.spline, &samples, "limit"})});
    drawings.push_back(
        {stem + "_comb.svg", svg_picture({result.spline, nullptr, "curvature comb", true})});
    return result;
}

Samples paper_helix() {
    PointSet q(20, 3);
    for (Index i = 0; i < 20; ++i) {
        const double t = 8 * std::numbers::pi * static_cast<double>(i) / 19;
        q(i, 0) = 6 * std::cos(t);
        q(i, 1) = 6 * std::sin(t);
        q(i, 2) = 2 * t;
    }
    Samples samples;
    samples.points = Points(std::move(q));
    return samples;
}

/// An uneven convex polygon on which plain PIA loses convexity.
Samples convex_polygon() {
    std::mt19937_64 random(0);
    std::uniform_real_distribution<double> step(0.05, 1);
    std::vector<double> angle{0};
    for (int i = 0; i < 11; ++i) angle.push_back(angle.back() + step(random));
    PointSet q(12, 2);
    for (Index i = 0; i < 12; ++i) {
        const double a = angle[static_cast<std::size_t>(i)] / angle.back() * 1.8 * std::numbers::pi;
        q(i, 0) = 3 * std::cos(a);
        q(i, 1) = std::sin(a);
    }
    Samples samples;
    samples.points = Points(std::move(q));
    return samples;
}

std::vector<Reproduced> pia(Drawings& drawings) {
    constexpr std::array<std::size_t, 5> steps{0, 2, 4, 15, 30};
    const std::array<std::array<double, 5>, 2> table_1{
        {{1.9603, 0.28645, 6.6263e-3, 3.7651e-5, 2.1624e-7},
         {33.628, 0.35526, 0.17233, 1.5282e-2, 1.2695e-3}}};
    FitOptions options;
    options.method.name = "pia";
    options.stop = {.max_iterations = 30, .relative_gradient = 0};
    std::vector<Reproduced> rows;
    const auto add = [&](const std::string& what, const FitResult& result, std::size_t line) {
        for (std::size_t k = 0; k < steps.size(); ++k)
            rows.push_back({fmt::format("{}, error after {} steps", what, steps[k]),
                            table_1[line][k], result.report.history[steps[k]].max_deviation});
    };
    add("Fig. 3 helix", figures(paper_helix(), options, drawings, "pia_helix", {}), 0);
    add("Fig. 6 peaks", figures(generate("peaks", {30, 30}), options, drawings, "pia_peaks", {}),
        1);
    const Samples polygon = convex_polygon();
    const auto inflections = [](const FitResult& r) {
        return static_cast<double>(inflection_count(r.spline.control_points()));
    };
    rows.push_back({"Fig. 5 kind: inflections of the polygon, plain PIA", unprinted,
                    inflections(figures(polygon, options, drawings, "pia_plain", {0, 4}))});
    options.hold.preserve = Preserve::convexity;
    rows.push_back({"Fig. 5 kind: the same, convexity preserved", 0,
                    inflections(figures(polygon, options, drawings, "pia_convex", {0, 4}))});
    rows.back().published = unprinted;
    return rows;
}

std::vector<Reproduced> epia(Drawings& drawings) {
    std::vector<Reproduced> rows;
    const struct {
        double eta, start, end, iterations;
    } table_1[] = {{0.6, 37, 66, 70}, {0.9, 83, 92, 40}};
    for (const auto& [eta, start, end, iterations] : table_1) {
        FitOptions options;
        options.method = {.name = "epia", .settings = {{"eta", eta}}};
        options.stop = {.max_iterations = 300, .relative_gradient = 0, .deviation = 0.0035};
        Index first = 0;
        const FitResult result = figures(generate("letter"), options, drawings,
                                         fmt::format("epia_letter_{}", eta), {0, 15});
        options.stop.max_iterations = 0;
        first = fit(generate("letter"), options).report.control_shape[0];
        rows.push_back({fmt::format("Table 1, eta {}: control points at the start", eta), start,
                        static_cast<double>(first)});
        rows.push_back({fmt::format("Table 1, eta {}: at e_d <= 0.0035", eta), end,
                        static_cast<double>(result.report.control_shape[0])});
        rows.push_back({fmt::format("Table 1, eta {}: iterations", eta), iterations,
                        static_cast<double>(result.report.iterations)});
        rows.push_back({fmt::format("Table 1, eta {}: e_d", eta), eta < 0.7 ? 0.003501 : 0.003494,
                        result.report.deviation.maximum});
    }
    FitOptions options;
    options.method.name = "epia";
    options.stop = {.max_iterations = 100, .relative_gradient = 0, .deviation = 0.01};
    const FitResult patch =
        figures(generate("peaks", {121, 161}), options, drawings, "epia_peaks", {});
    rows.push_back(
        {"Table 2, patch: error at the start over that after 100", 0.053347 / 0.002576,
         patch.report.history.front().max_deviation / patch.report.history.back().max_deviation});
    return rows;
}

FitOptions example_3(const char* method, Index n, Initial initial) {
    FitOptions options;
    options.shape.control_points = {n};
    options.method = {
        .name = method, .settings = {{"eigenvalue_tolerance", printed_digits}}, .initial = initial};
    options.stop = {.gradient = 1e-8, .relative_gradient = 0};
    return options;
}

std::vector<Reproduced> mlspia(Drawings& drawings) {
    const Samples rose = generate("rose", {501});
    std::vector<Reproduced> rows;
    const std::array<Index, 7> n{501 / 12, 501 / 10, 501 / 8,    501 / 6,
                                 501 / 4,  501 / 2,  2 * 501 / 3};
    const std::array<double, 7> zero{56, 55, 55, 55, 55, 85, 696};
    const std::array<double, 7> data{49, 47, 48, 48, 49, 74, 570};
    for (std::size_t k = 0; k < n.size(); ++k) {
        const auto count = [&](Initial initial) {
            return static_cast<double>(
                fit(rose, example_3("mlspia", n[k], initial)).report.iterations);
        };
        rows.push_back({fmt::format("Table 1, Example 3, {} control points, I", n[k]), zero[k],
                        count(Initial::zero)});
        rows.push_back({fmt::format("Table 1, Example 3, {} control points, II", n[k]), data[k],
                        count(Initial::data)});
    }
    const FitReport fast = figures(rose, example_3("mlspia", 50, Initial::data), drawings,
                                   "mlspia_example3", {0, 5, 10})
                               .report;
    const FitReport slow =
        figures(rose, example_3("lspia", 50, Initial::data), drawings, "lspia_example3", {}).report;
    rows.push_back({"Table 2, Example 3: omega*", 0.589932226424, fast.settings.at("omega")});
    rows.push_back({"Table 2, Example 3: nu*", 0.418520492365, fast.settings.at("nu")});
    rows.push_back({"Table 2, Example 3: mu* of LSPIA", 0.175097063057, slow.settings.at("mu")});
    rows.push_back(
        {"Table 2, Example 3: iterations of MLSPIA", 47, static_cast<double>(fast.iterations)});
    rows.push_back({"Table 2, Example 3: iterations of LSPIA (paper: 2-norm)", 156,
                    static_cast<double>(slow.iterations)});
    Index least = 1000000;
    Index most = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        FitOptions options = example_3("mlspia", 50, Initial::given);
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> value(-200000, 200000);
        options.method.control = PointSet(50, 2);
        for (double& x : options.method.control.values()) x = value(random);
        const Index iterations = fit(rose, options).report.iterations;
        least = std::min(least, iterations);
        most = std::max(most, iterations);
    }
    rows.push_back(
        {"Table 3, Example 3, random starts: fewest iterations", 82, static_cast<double>(least)});
    rows.push_back(
        {"Table 3, Example 3, random starts: most iterations", 87, static_cast<double>(most)});
    return rows;
}

std::vector<Reproduced> clspia(Drawings& drawings) {
    std::vector<Reproduced> rows;
    const struct {
        const char* name;
        Index samples, control, every;
        double e;
    } examples[] = {{"letter", 577, 55, 50, 5.2012e-22}, {"naca2412", 205, 20, 20, 1.7835e-21}};
    for (const auto& [name, samples, control, every, e] : examples) {
        const Samples q = generate(name, {samples});
        FitOptions options;
        options.shape.control_points = {control};
        options.method.name = "clspia";
        options.stop = {.max_iterations = 100000, .relative_gradient = 1e-12};
        for (Index i = 0; i < q.size(); i += every) options.hold.interpolate.push_back(i);
        const FitResult result =
            figures(q, options, drawings, fmt::format("clspia_{}", name), {0, 1, 3, 7});
        const auto exact = static_cast<double>(options.hold.interpolate.size());
        rows.push_back({fmt::format("Table 1 kind, {}: E after 100 000 iterations or less", name),
                        e, result.report.history.back().constraint_error / exact});
        rows.push_back({fmt::format("Table 1 kind, {}: inner iterations", name), unprinted,
                        result.report.settings.at("inner_iterations")});
        rows.push_back({fmt::format("Table 1 kind, {}: outer iterations", name), unprinted,
                        result.report.settings.at("outer_iterations")});
    }
    FitOptions options;
    options.shape.control_points = {30};
    options.hold = {.interpolate = {0, 200}, .preserve = Preserve::inflections};
    options.method.name = "clspia";
    options.stop.max_iterations = 2000;
    const FitResult kept = figures(generate("naca2412"), options, drawings, "clspia_shape", {0});
    rows.push_back({"Fig. 17 kind: inflections with the shape preserved", unprinted,
                    static_cast<double>(kept.report.inflections)});
    return rows;
}

} // namespace

std::span<const Paper> papers() {
    static const std::vector<Paper> all = {
        {"pia", "Lin, Wang, Dong 2004",
         "The data of Figs. 4 and 5 are not printed; helix and peaks are sampled by the stated "
         "formulas, whose ranges the paper leaves open.",
         pia},
        {"epia", "Lin, Zhang 2011",
         "The glyph and the scanned patch are not public: a letter G of 269 points and peaks 121 x "
         "161 stand in.",
         epia},
        {"mlspia", "Huang, Wang 2020",
         "Example 3 is given by its formula; the other examples' data are not public. The paper "
         "prints 1e-7 as its stop, its counts are those of 1e-8.",
         mlspia},
        {"clspia", "Chang, Ma, Deng 2023",
         "Built-in data of the same sizes stand in for the glyph and the profile.", clspia},
        {"salspia", "Peng, Li 2026",
         "Not run, for their data are not to be had here: 4.3 (reindeer), 4.6 (terrain), 4.7 "
         "(loop), 4.8 (a start interpolated over a triangulation that is not unique). The stop "
         "rule tests "
         "the square of the relative gradient, 1e-6. alspia takes the authors' cycle of 10000 "
         "roots, in which these steps are all but the largest eigenvalue's.",
         peng_li},
    };
    return all;
}

} // namespace batten::command
