#include <batten/samples/generate.hpp>

#include <batten/core/counts.hpp>
#include <batten/core/names.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

namespace batten {

namespace {

using std::numbers::pi;

/// `count` values, evenly from a to b.
double evenly(Index i, Index count, double a, double b) {
    return a + (b - a) * static_cast<double>(i) / static_cast<double>(count - 1);
}

Samples curve(PointSet points) {
    return {.points = std::move(points)};
}

/// The points that `point_at` has for each place of the grid.
template <class PointAt>
Samples grid_in_space(const std::vector<Index>& size, PointAt point_at) {
    const GridIndex grid(size);
    PointSet points(grid.size(), 3);
    grid.for_each([&](const GridIndex::Place& place, Index i) {
        std::ranges::copy(point_at(place), points[i].begin());
    });
    return {.points = std::move(points), .grid = size};
}

/// r = sin(theta / 4), theta uniform on [0, 8 pi]: [HuangWang2020, Example 3].
Samples rose(std::vector<Index> size) {
    PointSet points(size[0], 2);
    for (Index i = 0; i < size[0]; ++i) {
        const double theta = evenly(i, size[0], 0, 8 * pi);
        points(i, 0) = std::sin(theta / 4) * std::cos(theta);
        points(i, 1) = std::sin(theta / 4) * std::sin(theta);
    }
    return curve(std::move(points));
}

/// (5 cos t, 5 sin t, t), t on [0, 6 pi].
Samples helix(std::vector<Index> size) {
    PointSet points(size[0], 3);
    for (Index i = 0; i < size[0]; ++i) {
        const double t = evenly(i, size[0], 0, 6 * pi);
        points(i, 0) = 5 * std::cos(t);
        points(i, 1) = 5 * std::sin(t);
        points(i, 2) = t;
    }
    return curve(std::move(points));
}

Samples circle(std::vector<Index> size) {
    PointSet points(size[0], 2);
    for (Index i = 0; i < size[0]; ++i) {
        const double t = evenly(i, size[0], 0, 2 * pi);
        points(i, 0) = std::cos(t);
        points(i, 1) = std::sin(t);
    }
    points(size[0] - 1, 0) = points(0, 0);
    points(size[0] - 1, 1) = points(0, 1);
    return curve(std::move(points));
}

Samples naca2412(std::vector<Index> size) {
    return naca4("2412", size[0]);
}
Samples naca0012(std::vector<Index> size) {
    return naca4("0012", size[0]);
}

/// The outline of a letter G of unit height: two arcs, straight strokes and sharp corners, closed.
Samples letter(std::vector<Index> size) {
    struct Piece {
        double x0, y0, x1,
            y1; // a stroke, or with radius > 0 an arc around (x0, y0) from angle x1 to y1
        double radius;
        double length() const {
            return radius > 0 ? radius * std::abs(y1 - x1) : std::hypot(x1 - x0, y1 - y0);
        }
    };
    const double a = pi / 5;
    const double outer = 0.5;
    const double inner = 0.36;
    const double cx = 0.5;
    const auto on = [&](double r, double angle) {
        return std::array{cx + r * std::cos(angle), cx + r * std::sin(angle)};
    };
    const auto start = on(inner, a), tip = on(outer, a);
    const std::vector<Piece> pieces = {
        {start[0], start[1], tip[0], tip[1], 0},
        {cx, cx, a, 2 * pi, outer},
        {1, 0.5, 0.6, 0.5, 0},
        {0.6, 0.5, 0.6, 0.38, 0},
        {0.6, 0.38, cx + std::sqrt(inner * inner - 0.12 * 0.12), 0.38, 0},
        {cx, cx, 2 * pi - std::asin(0.12 / inner), a, inner},
    };
    double total = 0;
    for (const Piece& piece : pieces) total += piece.length();
    PointSet points(size[0], 2);
    std::size_t at = 0;
    double before = 0;
    for (Index i = 0; i < size[0]; ++i) {
        const double s = evenly(i, size[0], 0, total);
        while (at + 1 < pieces.size() && s > before + pieces[at].length())
            before += pieces[at++].length();
        const Piece& piece = pieces[at];
        const double part = std::min(1.0, (s - before) / piece.length());
        const double first = piece.x1 + part * (piece.y1 - piece.x1); // an arc's angle
        points(i, 0) = piece.radius > 0 ? piece.x0 + piece.radius * std::cos(first)
                                        : piece.x0 + part * (piece.x1 - piece.x0);
        points(i, 1) = piece.radius > 0 ? piece.y0 + piece.radius * std::sin(first)
                                        : piece.y0 + part * (piece.y1 - piece.y0);
    }
    return curve(std::move(points));
}

double peaks_height(double x, double y) {
    return 3 * (1 - x) * (1 - x) * std::exp(-x * x - (y + 1) * (y + 1)) -
           10 * (x / 5 - x * x * x - std::pow(y, 5)) * std::exp(-x * x - y * y) -
           std::exp(-(x + 1) * (x + 1) - y * y) / 3;
}

/// The "peaks" surface over [-3, 3] x [-4, 4].
Samples peaks(std::vector<Index> size) {
    return grid_in_space(size, [&](const GridIndex::Place& place) {
        const double x = evenly(place[0], size[0], -3, 3);
        const double y = evenly(place[1], size[1], -4, 4);
        return std::array{x, y, peaks_height(x, y)};
    });
}

Samples torus(std::vector<Index> size) {
    return grid_in_space(size, [&](const GridIndex::Place& place) {
        const double u = 2 * pi * static_cast<double>(place[0]) / static_cast<double>(size[0]);
        const double v = 2 * pi * static_cast<double>(place[1]) / static_cast<double>(size[1]);
        const double radius = 3 + std::cos(v);
        return std::array{radius * std::cos(u), radius * std::sin(u), std::sin(v)};
    });
}

/// A block bent and swollen: a volume with curved faces.
Samples bent_block(std::vector<Index> size) {
    return grid_in_space(size, [&](const GridIndex::Place& place) {
        const double angle = evenly(place[0], size[0], 0, pi / 2);
        const double radius = evenly(place[1], size[1], 2, 3) + 0.2 * std::sin(4 * angle);
        return std::array{radius * std::cos(angle), radius * std::sin(angle),
                          evenly(place[2], size[2], 0, 1) * (1 + 0.3 * std::sin(2 * angle))};
    });
}

const std::vector<Generator>& table() {
    static const std::vector<Generator> all = {
        {"naca2412",
         "NACA 2412 airfoil, unit chord, cosine spacing (planar curve)",
         naca2412,
         {201}},
        {"naca0012",
         "NACA 0012 airfoil, unit chord, cosine spacing (planar curve)",
         naca0012,
         {201}},
        {"rose", "r = sin(theta/4), theta on [0, 8 pi] (planar curve)", rose, {501}},
        {"circle", "unit circle, first point repeated at the end (planar curve)", circle, {101}},
        {"letter", "outline of a letter G with sharp corners (planar curve)", letter, {269}},
        {"helix", "(5 cos t, 5 sin t, t), t on [0, 6 pi] (space curve)", helix, {400}},
        {"peaks", "the peaks function over [-3,3] x [-4,4] (grid of 2 axes)", peaks, {121, 121}},
        {"torus",
         "torus of radii 3 and 1, closed along both axes (grid of 2 axes)",
         torus,
         {60, 40}},
        {"bent-block", "a bent block (grid of 3 axes)", bent_block, {24, 12, 8}},
    };
    return all;
}

} // namespace

std::span<const Generator> generators() {
    return table();
}

Samples generate(std::string_view name, std::vector<Index> size) {
    std::vector<std::string_view> names;
    for (const Generator& g : table()) {
        names.push_back(g.name);
        if (g.name != name) continue;
        if (size.empty()) size = g.default_size;
        if (size.size() != g.default_size.size())
            throw InvalidInput(fmt::format("{}: {} axes, but a size of {} was asked for", name,
                                           g.default_size.size(), fmt::join(size, "x")));
        for (Index m : size)
            if (m < 2 || m > 100'000'000)
                throw InvalidInput(
                    fmt::format("{}: {} samples along an axis is outside 2 to 100000000", name, m));
        size.push_back(3); // coordinates at most
        check_memory(checked_product(size, name), name);
        size.pop_back();
        return g.make(std::move(size));
    }
    throw InvalidInput(unknown_name("data set", name, names));
}

Samples naca4(std::string_view digits, Index count) {
    if (digits.size() != 4 || digits.find_first_not_of("0123456789") != std::string_view::npos)
        throw InvalidInput(fmt::format("NACA section '{}': four digits are needed", digits));
    if (count < 5 || count % 2 == 0)
        throw InvalidInput(
            fmt::format("NACA section: {} points given, an odd number from 5 is needed", count));
    const double camber = (digits[0] - '0') / 100.0;
    const double where = (digits[1] - '0') / 10.0;
    const double thickness = ((digits[2] - '0') * 10 + (digits[3] - '0')) / 100.0;
    PointSet points(count, 2);
    const Index half = (count - 1) / 2;
    for (Index i = 0; i < count; ++i) {
        const double x =
            (1 + std::cos(pi * static_cast<double>(i) / static_cast<double>(half))) / 2;
        const double y = 5 * thickness *
                         (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x -
                          0.1015 * x * x * x * x);
        double line = 0;
        double slope = 0;
        if (camber > 0 && x < where) {
            line = camber / (where * where) * (2 * where * x - x * x);
            slope = 2 * camber / (where * where) * (where - x);
        } else if (camber > 0) {
            const double rest = (1 - where) * (1 - where);
            line = camber / rest * (1 - 2 * where + 2 * where * x - x * x);
            slope = 2 * camber / rest * (where - x);
        }
        const double angle = std::atan(slope);
        const double side = i <= half ? 1 : -1;
        points(i, 0) = x - side * y * std::sin(angle);
        points(i, 1) = line + side * y * std::cos(angle);
    }
    return curve(std::move(points));
}

} // namespace batten
