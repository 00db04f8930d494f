#include "convergence_plot.hpp"
#include "papers.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/samples/generate.hpp>

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <random>

namespace batten::command {

namespace {

constexpr Index most_iterations = 2000;
constexpr double goal = 1e-6; ///< of the first gradient's length
constexpr double drawn_to = 1e-10;

struct RaceProblem {
    std::string name;
    Samples samples;
    FitOptions options;
};

FitOptions with_control(std::vector<Index> control, int degree = 3) {
    FitOptions options;
    options.shape.degree.assign(control.size(), degree);
    options.shape.control_points = std::move(control);
    return options;
}

/// Uniform knots, and no samples over a fifth of the curve: whole spans are undetermined.
RaceProblem curve_with_a_gap() {
    const Samples rose = generate("rose", {501});
    const Parameters all = parametrize(rose, Parametrization::chord, {Closure::open});
    std::vector<double> points;
    std::vector<double> at;
    for (Index i = 0; i < rose.size(); ++i) {
        const double t = all.axes[0][static_cast<std::size_t>(i)];
        if (t > 0.4 && t < 0.6) continue;
        at.push_back(t);
        points.insert(points.end(), rose.points[i].begin(), rose.points[i].end());
    }
    FitOptions options;
    const KnotVector knots = uniform_knots(3, 60, 0, 1);
    options.shape.knots = {{knots.knots().begin(), knots.knots().end()}};
    options.shape.parameters = Parameters{{std::move(at)}, {}};
    return {"curve with a gap", {.points = Points(PointSet(std::move(points), 2))}, options};
}

/// Random places in the square, without a disk of that radius, heights with some noise.
RaceProblem cloud(const std::string& name, double hole, double crowding) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> noise(0, 0.01);
    std::vector<double> places;
    std::vector<double> points;
    while (places.size() < 2 * 6000) {
        const double u = std::pow(unit(random), crowding);
        const double v = std::pow(unit(random), crowding);
        if (std::hypot(u - 0.5, v - 0.5) < hole) continue;
        places.insert(places.end(), {u, v});
        points.insert(points.end(), {u, v, std::sin(5 * u) * std::cos(4 * v) + noise(random)});
    }
    FitOptions options;
    const KnotVector knots = uniform_knots(3, 24, 0, 1);
    options.shape.knots.assign(2, {knots.knots().begin(), knots.knots().end()});
    options.shape.parameters = Parameters{{}, PointSet(std::move(places), 2)};
    return {name, {.points = Points(PointSet(std::move(points), 3))}, options};
}

std::vector<RaceProblem> problems() {
    FitOptions closed = with_control({40, 20});
    closed.shape.closures = {Closure::closed, Closure::closed};
    FitOptions smooth = with_control({120});
    smooth.smooth = {.wanted = true, .lambda = 1e-3};
    return {{"rose, 50 control points", generate("rose", {501}), with_control({50})},
            {"rose, 334 control points", generate("rose", {501}), with_control({334})},
            {"letter, degree 7", generate("letter", {577}), with_control({60}, 7)},
            {"letter, smoothed", generate("letter", {577}), smooth},
            curve_with_a_gap(),
            {"peaks, 41 x 41", generate("peaks", {121, 121}), with_control({41, 41})},
            {"torus, closed", generate("torus", {96, 48}), closed},
            cloud("cloud, even", 0, 1),
            cloud("cloud, crowded, with a hole", 0.2, 2),
            {"volume", generate("bent-block", {40, 24, 16}), with_control({12, 8, 6})}};
}

/// Not here: nmlspia and pmlspia, which are nesterov and mlspia; fairing-pia and monotone-lspia,
/// whose limits are others.
constexpr std::array racers{
    "lspia",   "lin2018", "alspia",   "mlspia", "chebyshev", "nesterov", "barzilai-borwein",
    "salspia", "plspia",  "anderson", "rpia",   "cg"};

/// Iterations until the gradient is `goal` of the first, and the seconds that these took.
Table run(const RaceProblem& course, std::size_t number, Workshop& workshop) {
    Table table{course.name, {}};
    std::vector<Series> lines;
    for (const char* method : racers) {
        FitOptions options = course.options;
        options.method.name = method;
        options.stop = {.max_iterations = most_iterations, .relative_gradient = drawn_to};
        Series line{method, {}};
        options.observer = [&](const Iteration& now) {
            line.values.push_back(now.gradient_norm);
            return Continue::yes;
        };
        const double first = fit(course.samples, options).report.first_gradient_norm;
        for (double& value : line.values) value /= first;
        lines.push_back(std::move(line));
        options.observer = {};
        options.stop.relative_gradient = goal;
        Stopwatch clock;
        const FitReport timed = fit(course.samples, options).report;
        const double seconds = clock.lap();
        const bool there = timed.termination == Termination::converged;
        table.rows.push_back({fmt::format("{}: iterations{}", method, there ? "" : ", not there"),
                              "", static_cast<double>(timed.iterations)});
        table.rows.push_back({fmt::format("{}: seconds, set-up counted", method), "", seconds});
    }
    table.pictures = fmt::format("race_{}.svg", number);
    workshop.drawings.push_back(
        {table.pictures, convergence_plot(course.name, "gradient, in parts of the first", lines)});
    return table;
}

} // namespace

std::vector<Table> race(Workshop& workshop) {
    std::vector<Table> tables;
    for (const RaceProblem& course : problems())
        tables.push_back(run(course, tables.size() + 1, workshop));
    return tables;
}

} // namespace batten::command
