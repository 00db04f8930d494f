#include "reproduce.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/fit/fit.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace batten::command {

namespace {

constexpr double pi = std::numbers::pi;

/// n places from a to b, both of them.
std::vector<double> spread(double a, double b, Index n) {
    std::vector<double> result;
    for (Index i = 0; i < n; ++i)
        result.push_back(a + (b - a) * static_cast<double>(i) / static_cast<double>(n - 1));
    return result;
}

template <class At>
Samples curve(const std::vector<double>& places, Index dim, At at) {
    PointSet points(static_cast<Index>(places.size()), dim);
    for (Index i = 0; i < points.size(); ++i) at(places[static_cast<std::size_t>(i)], points[i]);
    return {.points = Points(std::move(points))};
}

template <class At>
Samples surface(const std::vector<double>& u, const std::vector<double>& v, At at) {
    PointSet points(static_cast<Index>(u.size() * v.size()), 3);
    Index i = 0;
    for (double x : u)
        for (double y : v) at(x, y, points[i++]);
    return {.points = Points(std::move(points)),
            .grid = {static_cast<Index>(u.size()), static_cast<Index>(v.size())}};
}

Samples blob(Index m) {
    return curve(spread(0, 2 * pi, m), 2, [](double t, std::span<double> q) {
        const double r = 2 + 4 * std::cos(2 * t + pi / 4) + std::cos(3 * t + pi / 4);
        q[0] = r * std::cos(t);
        q[1] = r * std::sin(t);
    });
}

Samples helix(double last, Index m) {
    return curve(spread(0, last, m), 3, [](double t, std::span<double> q) {
        q[0] = 10 * std::cos(t * pi / 3);
        q[1] = 10 * std::sin(t * pi / 3);
        q[2] = t * pi / 3;
    });
}

Samples dini() {
    return surface(spread(0, 4 * pi, 81), spread(0.1, pi - 0.1, 81),
                   [](double u, double v, std::span<double> q) {
                       q[0] = std::cos(u) * std::sin(v);
                       q[1] = std::sin(u) * std::sin(v);
                       q[2] = std::cos(v) + std::log(std::tan(v / 2)) + u;
                   });
}

Samples peaks() {
    return surface(spread(-3, 3, 121), spread(-4, 4, 121),
                   [](double x, double y, std::span<double> q) {
                       q[0] = x;
                       q[1] = y;
                       q[2] = 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
                              10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
                              std::exp(-(x + 1) * (x + 1) - y * y) / 3;
                   });
}

std::vector<double> numbers(const KnotVector& axis) {
    return {axis.knots().begin(), axis.knots().end()};
}

/// Samples, the space and the start of an experiment.
struct Experiment {
    Samples samples;
    FitOptions options;
};

/// Curves: chord-length parameters, knots between them, samples picked evenly as the start.
Experiment along_curve(Samples samples, Index n) {
    const Parameters t = parametrize(samples, Parametrization::chord, {Closure::open});
    const Index m = samples.size();
    PointSet start(n, samples.dim());
    for (Index i = 0; i < n; ++i)
        std::ranges::copy(samples.points[std::min(m - 1, m * i / (n - 1))], start[i].begin());
    FitOptions options;
    options.shape.knots = {numbers(knots_from_parameters(t.axes[0], 3, n))};
    options.shape.parameters = t;
    options.method.initial = Initial::given;
    options.method.control = std::move(start);
    return {std::move(samples), std::move(options)};
}

/// Surfaces: everything evenly, the start at the nearest samples.
Experiment over_grid(Samples samples, Index n) {
    const Index m = samples.grid[0];
    PointSet start(n * n, 3);
    const auto nearest = [&](Index i) { return (2 * i * (m - 1) + n - 1) / (2 * (n - 1)); };
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
            std::ranges::copy(samples.points[nearest(i) * m + nearest(j)],
                              start[i * n + j].begin());
    FitOptions options;
    options.shape.knots.assign(2, numbers(uniform_knots(3, n, 0, 1)));
    options.shape.parametrization = Parametrization::uniform;
    options.method.initial = Initial::given;
    options.method.control = std::move(start);
    return {std::move(samples), std::move(options)};
}

/// What is within `half` of one of the centres is taken away, after everything was chosen by it.
Samples take_away(Experiment& from, const std::vector<double>& centres, double half,
                  std::vector<double>& taken_at) {
    std::vector<double> kept_at;
    std::vector<double> kept;
    std::vector<double> taken;
    const Samples& all = from.samples;
    const std::vector<double> t = from.options.shape.parameters->axes[0];
    for (Index i = 0; i < all.size(); ++i) {
        const double at = t[static_cast<std::size_t>(i)];
        const bool away = std::ranges::any_of(
            centres, [&](double c) { return at >= c - half && at <= c + half; });
        (away ? taken_at : kept_at).push_back(at);
        std::vector<double>& to = away ? taken : kept;
        to.insert(to.end(), all.points[i].begin(), all.points[i].end());
    }
    Samples hole{.points = Points(PointSet(std::move(taken), all.dim()))};
    from.samples = {.points = Points(PointSet(std::move(kept), all.dim()))};
    from.options.shape.parameters->axes[0] = std::move(kept_at);
    return hole;
}

FitResult run(const Experiment& experiment, std::string_view method) {
    FitOptions options = experiment.options;
    options.method.name = method;
    if (method == "alspia") options.method.settings["cycle"] = 10000;
    if (method == "cg") options.method.settings["plain"] = 1;
    if (method == "lspia" || method == "alspia" || method == "mlspia" || method == "nmlspia")
        options.method.settings["eigenvalue_tolerance"] = 1e-10;
    options.stop.relative_gradient = 1e-3; // its square is what the paper's stop rule tests
    return fit(experiment.samples, options);
}

double error(const FitReport& report) { // E, in 1e-7
    const double part = report.gradient_norm / report.first_gradient_norm;
    return 1e7 * part * part;
}

struct Line {
    const char* method;
    double iterations, error, rms, largest;
};

/// A row for each figure of the lines; `where` says of what `deviation(result)` is.
template <class Deviate>
void compare(const std::string& what, const Experiment& experiment, const std::vector<Line>& lines,
             const char* where, Deviate deviation, std::vector<Reproduced>& rows) {
    for (const auto& [method, iterations, e, rms, largest] : lines) {
        const FitResult result = run(experiment, method);
        const FitReport& report = result.report;
        const std::string name = fmt::format("{}, {}: ", what, method);
        rows.push_back({name + "iterations", iterations, static_cast<double>(report.iterations)});
        if (!std::isfinite(e)) continue;
        const Deviation there = deviation(result);
        rows.push_back({name + "E in 1e-7", e, error(report)});
        rows.push_back({name + "rms" + where, rms, there.rms});
        rows.push_back({name + "largest" + where, largest, there.maximum});
    }
}

/// The deviation of the samples, and what the direct answer leaves.
void compare_full(const std::string& what, Experiment experiment, const std::vector<Line>& lines,
                  std::vector<Reproduced>& rows) {
    compare(
        what, experiment, lines, "", [](const FitResult& r) { return r.report.deviation; }, rows);
    experiment.options.method = {};
    rows.push_back(
        {what + ", direct, ours: rms", unprinted, run(experiment, "direct").report.deviation.rms});
}

/// The deviation of what is taken away.
void compare_hole(const std::string& what, Experiment experiment,
                  const std::vector<double>& centres, const std::vector<Line>& lines,
                  std::vector<Reproduced>& rows) {
    std::vector<double> at;
    const Samples hole = take_away(experiment, centres, 0.02, at);
    compare(
        what, experiment, lines, " in the holes",
        [&](const FitResult& r) {
            return summarise(parametric_deviations(r.spline, hole, {.axes = {at}}),
                             DeviationKind::parametric);
        },
        rows);
}

} // namespace

std::vector<Reproduced> peng_li(Drawings&) {
    std::vector<Reproduced> rows;
    const double none = unprinted;
    compare_full("4.1 blob", along_curve(blob(15001), 3001),
                 {{"lspia", 77, 9.336, 1.073e-5, 2.552e-5},
                  {"alspia", 6, 9.415, 2.383e-5, 1.081e-3},
                  {"mlspia", 25, 7.338, 9.510e-6, 2.288e-5},
                  {"nmlspia", 5, 9.739, 1.763e-5, 5.298e-4},
                  {"salspia", 4, 8.164, 2.279e-5, 1.135e-3},
                  {"cg", none, none, none, none}},
                 rows);
    compare_full("4.2 helix", along_curve(helix(2 * pi, 10001), 2001),
                 {{"lspia", 77, 9.646, 2.084e-5, 3.836e-5},
                  {"alspia", 7, 6.292, 3.859e-5, 1.503e-3},
                  {"mlspia", 25, 7.736, 1.867e-5, 3.482e-5},
                  {"nmlspia", 6, 3.595, 2.235e-5, 5.400e-4},
                  {"salspia", 4, 9.155, 4.615e-5, 1.875e-3},
                  {"cg", none, none, none, none}},
                 rows);
    compare_full("4.4 Dini", over_grid(dini(), 31),
                 {{"lspia", 213, 9.756, 3.383e-4, 9.728e-4},
                  {"alspia", 37, 9.188, 1.273e-3, 2.323e-2},
                  {"mlspia", 82, 6.922, 3.110e-4, 1.010e-3},
                  {"nmlspia", 30, 8.664, 9.507e-4, 4.707e-3},
                  {"salspia", 14, 3.371, 6.246e-4, 1.231e-2},
                  {"cg", none, none, none, none}},
                 rows);
    compare_full("4.5 peaks", over_grid(peaks(), 41),
                 {{"lspia", 1091, 9.942, 3.408e-4, 1.892e-3},
                  {"alspia", 15, 8.701, 7.832e-4, 1.128e-2},
                  {"mlspia", 109, 8.394, 3.248e-4, 1.862e-3},
                  {"nmlspia", 17, 8.722, 6.446e-4, 5.182e-3},
                  {"salspia", 8, 5.731, 5.827e-4, 7.983e-3},
                  {"cg", none, none, none, none}},
                 rows);
    compare_hole("4.1 with holes", along_curve(blob(331), 101), {0.20, 0.42, 0.62, 0.82},
                 {{"lin2018", 18, 9.349, 7.273e-2, 0.18066},
                  {"alspia", 38, 9.624, 0.11878, 0.22715},
                  {"salspia", 14, 4.402, 0.11536, 0.22019},
                  {"cg", none, none, none, none}},
                 rows);
    compare_hole("4.2 with holes", along_curve(helix(30, 521), 201), {0.25, 0.50, 0.75},
                 {{"lin2018", 26, 8.705, 0.48286, 1.1494},
                  {"alspia", 32, 9.064, 0.64879, 1.1977},
                  {"salspia", 14, 7.512, 0.64236, 1.1959},
                  {"cg", none, none, none, none}},
                 rows);
    return rows;
}

} // namespace batten::command
