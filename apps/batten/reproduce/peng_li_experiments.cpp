#include "peng_li_experiments.hpp"

#include <batten/basis/place_knots.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

std::vector<double> numbers(const KnotVector& axis) {
    return {axis.knots().begin(), axis.knots().end()};
}

} // namespace

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

Samples peaks_over_8() {
    return surface(spread(-3, 3, 121), spread(-4, 4, 121),
                   [](double x, double y, std::span<double> q) {
                       q[0] = x;
                       q[1] = y;
                       q[2] = 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
                              10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
                              std::exp(-(x + 1) * (x + 1) - y * y) / 3;
                   });
}

Samples franke() {
    const std::vector<double> places = spread(0, 1, 101);
    return surface(places, places, [](double x, double y, std::span<double> q) {
        const auto square = [](double t) { return t * t; };
        q[0] = x;
        q[1] = y;
        q[2] = 0.75 * std::exp(-(square(9 * x - 2) + square(9 * y - 2)) / 4) +
               0.75 * std::exp(-square(9 * x + 1) / 49 - (9 * y + 1) / 10) +
               0.5 * std::exp(-(square(9 * x - 7) + square(9 * y - 3)) / 4) -
               0.2 * std::exp(-square(9 * x - 4) - square(9 * y - 7));
    });
}

Samples mount_eden(const PointSet& heights) {
    Index i = 0;
    return surface(spread(0, 865, heights.size()), spread(0, 605, heights.dim()),
                   [&](double x, double y, std::span<double> q) {
                       q[0] = x;
                       q[1] = y;
                       q[2] = heights.values()[static_cast<std::size_t>(i++)];
                   });
}

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

/// The sample nearest to place i of n, by one rule for both axes.
Index nearest_sample(Index i, Index samples, Index n) {
    return (2 * i * (samples - 1) + n - 1) / (2 * (n - 1));
}

Experiment over_grid(Samples samples, Index n) {
    const Index rows = samples.grid[0];
    const Index columns = samples.grid[1];
    PointSet start(n * n, 3);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
            std::ranges::copy(samples.points[nearest_sample(i, rows, n) * columns +
                                             nearest_sample(j, columns, n)],
                              start[i * n + j].begin());
    FitOptions options;
    options.shape.knots.assign(2, numbers(uniform_knots(3, n, 0, 1)));
    options.shape.parametrization = Parametrization::uniform;
    options.method.initial = Initial::given;
    options.method.control = std::move(start);
    return {std::move(samples), std::move(options)};
}

void take_away(Experiment& from, const std::function<bool(std::span<const double>)>& gone) {
    const Samples& all = from.samples;
    ShapeOptions& shape = from.options.shape;
    const Parameters parameters =
        shape.parameters ? *shape.parameters
                         : parametrize(all, shape.parametrization.value_or(Parametrization::chord),
                                       std::vector(all.grid.size(), Closure::open));
    const PointSet rows = parameter_rows(parameters);
    struct Part {
        std::vector<double> points, at;
    } kept, taken;
    for (Index i = 0; i < all.size(); ++i) {
        Part& to = gone(rows[i]) ? taken : kept;
        to.points.insert(to.points.end(), all.points[i].begin(), all.points[i].end());
        to.at.insert(to.at.end(), rows[i].begin(), rows[i].end());
    }
    const auto samples = [&](Part& part) {
        return Samples{.points = Points(PointSet(std::move(part.points), all.dim()))};
    };
    const auto places = [&](Part& part) {
        return rows.dim() == 1 ? Parameters{{std::move(part.at)}, {}}
                               : Parameters{{}, PointSet(std::move(part.at), rows.dim())};
    };
    from.hole = samples(taken);
    from.hole_parameters = places(taken);
    shape.parameters = places(kept);
    shape.parametrization.reset();
    from.samples = samples(kept);
}

namespace {

struct Ellipse {
    double a, b, p, q;
    /// At most 1 inside.
    double at(std::span<const double> t) const {
        return std::pow((t[0] - a) / p, 2) + std::pow((t[1] - b) / q, 2);
    }
};

/// The height at `place`, linear over the triangle of the three points that Delaunay's rule names:
/// of all that hold the place, the one that is lowest there when the points are lifted to x^2 +
/// y^2.
double linear_height(std::span<const std::array<double, 3>> points, std::span<const double> place) {
    double lowest = std::numeric_limits<double>::infinity();
    double height = 0;
    const auto cross = [](const auto& a, const auto& b, const auto& c) {
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    };
    const auto lift = [&](const auto& a) { // about the place, for its digits
        return (a[0] - place[0]) * (a[0] - place[0]) + (a[1] - place[1]) * (a[1] - place[1]);
    };
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            const double side = cross(points[i], points[j], place);
            for (std::size_t k = j + 1; k < points.size(); ++k) {
                const double area = cross(points[i], points[j], points[k]);
                const double w = side / area;
                const double v = cross(points[k], points[i], place) / area;
                const double u = 1 - v - w;
                if (!(u >= 0 && v >= 0 && w >= 0)) continue;
                const double here = u * lift(points[i]) + v * lift(points[j]) + w * lift(points[k]);
                if (here >= lowest) continue;
                lowest = here;
                height = u * points[i][2] + v * points[j][2] + w * points[k][2];
            }
        }
    return height;
}

} // namespace

Experiment franke_with_holes() {
    constexpr std::array<Ellipse, 4> holes{
        {{.45, .25, .11, .12}, {.72, .62, .11, .11}, {.25, .55, .12, .11}, {.60, .85, .11, .11}}};
    constexpr double rim = 1.3; // times the ellipse: whoever can be a triangle's corner in it
    Experiment experiment = over_grid(franke(), 41);
    take_away(experiment, [&](std::span<const double> t) {
        return std::ranges::any_of(holes, [&](const Ellipse& e) { return e.at(t) <= 1; });
    });
    for (const Ellipse& hole : holes) {
        std::vector<std::array<double, 3>> around;
        for (Index i = 0; i < experiment.samples.size(); ++i) {
            const std::span<const double> q = experiment.samples.points[i];
            if (hole.at(q) < rim) around.push_back({q[0], q[1], q[2]});
        }
        PointSet& start = experiment.options.method.control;
        for (Index i = 0; i < start.size(); ++i)
            if (hole.at(start[i]) <= 1) start[i][2] = linear_height(around, start[i]);
    }
    return experiment;
}

} // namespace batten::command
