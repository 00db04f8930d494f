#include <batten/io/sampling.hpp>

#include <batten/io/cell_counts.hpp>
#include <batten/samples/samples.hpp>
#include <batten/spline/graph.hpp>
#include <batten/spline/section.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace batten {

namespace {

constexpr double most_points = 1e7;

/// What is left of the tolerance when points are moved by the rounding of their coordinates to
/// doubles, and by a file by `moved`: of that at least half.
double after_rounding(const Spline& spline, double chord, double moved) {
    if (!(chord > 0) || !std::isfinite(chord))
        throw InvalidInput(fmt::format("chord tolerance {}: must be positive and finite", chord));
    const double rounded = rounding(spline, std::numeric_limits<double>::epsilon());
    if (!(chord > 2 * rounded))
        throw InvalidInput(
            fmt::format("chord tolerance {}: double precision moves these points by up to {:.2g}",
                        chord, rounded));
    return std::max(chord / 2, chord - moved) - rounded / 2;
}

/// Whether the end of a surface's axis is one point.
bool is_pole(const Spline& surface, Index axis, double t, double apart) {
    const Spline line = section(surface, axis, t);
    const PointSet& control = line.control_points();
    for (Index i = 1; i < control.size(); ++i)
        if (!is_same_point(control[i], control[0], apart)) return false;
    return true;
}

/// Whether the spline's two ends along the axis are one.
bool closes(const Spline& spline, Index axis, double apart) {
    const KnotVector& knots = spline.axis(axis);
    if (knots.closed()) return true;
    if (spline.axis_count() == 1)
        return is_same_point(spline(std::array{knots.begin()}), spline(std::array{knots.end()}),
                             apart);
    const Spline first = section(spline, axis, knots.begin());
    const Spline last = section(spline, axis, knots.end());
    for (Index i = 0; i < first.control_points().size(); ++i)
        if (!is_same_point(first.control_points()[i], last.control_points()[i], apart))
            return false;
    return true;
}

Index sum(const std::vector<Index>& cells) {
    return std::accumulate(cells.begin(), cells.end(), Index{0});
}

/// Adds cells to the first spans until there are `least` along the axis.
void at_least(std::vector<Index>& cells, Index least) {
    for (std::size_t k = 0; sum(cells) < least; k = (k + 1) % cells.size()) ++cells[k];
}

/// Three cells around, two between poles: what fewer of them enclose is flat.
void enclose(const Spline& spline, double apart, CellCounts& cells) {
    for (Index k = 0; k < spline.axis_count(); ++k) {
        std::vector<Index>& along = cells[static_cast<std::size_t>(k)];
        if (sum(along) >= 3) continue;
        const KnotVector& axis = spline.axis(k);
        if (closes(spline, k, apart))
            at_least(along, 3);
        else if (spline.axis_count() == 2 && is_pole(spline, k, axis.begin(), apart) &&
                 is_pole(spline, k, axis.end(), apart))
            at_least(along, 2);
    }
}

void raise(std::vector<Index>& cells, const std::vector<Index>& least) {
    for (std::size_t b = 0; b < cells.size(); ++b) cells[b] = std::max(cells[b], least[b]);
}

CellCounts enclosing_cells(const Spline& spline, double chord, double apart) {
    CellCounts cells = least_cells(spline, chord);
    if (!is_function(spline)) enclose(spline, apart, cells);
    return cells;
}

/// Cells of a volume for its faces alone.
CellCounts skin_cells(const Spline& volume, double chord) {
    const double apart = same_point_distance(volume);
    CellCounts cells;
    for (const KnotVector& axis : volume.axes())
        cells.emplace_back(axis.breakpoints().size() - 1, 1);
    for (Index k = 0; k < 3; ++k) {
        if (!is_function(volume) && closes(volume, k, apart)) continue;
        for (double end : {volume.axis(k).begin(), volume.axis(k).end()}) {
            const CellCounts face = enclosing_cells(section(volume, k, end), chord, apart);
            for (Index f = 0; f < 2; ++f)
                raise(cells[static_cast<std::size_t>(f < k ? f : f + 1)],
                      face[static_cast<std::size_t>(f)]);
        }
    }
    if (!is_function(volume)) enclose(volume, apart, cells);
    return cells;
}

double points_along(const std::vector<Index>& cells) {
    return static_cast<double>(sum(cells)) + 1;
}

AxisPlaces places_of(const Spline& spline, const CellCounts& cells, double points, double chord) {
    if (!(points <= most_points))
        throw InvalidInput(fmt::format(
            "chord tolerance {}: more than {:.0e} points would be needed", chord, most_points));
    AxisPlaces result;
    for (std::size_t k = 0; k < cells.size(); ++k)
        result.push_back(divided(spline.axes()[k].breakpoints(), cells[k]));
    return result;
}

} // namespace

std::vector<double> divided(const std::vector<double>& breaks, const std::vector<Index>& pieces) {
    std::vector<double> t{breaks.front()};
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        for (Index k = 1; k <= pieces[b]; ++k)
            t.push_back(std::lerp(breaks[b], breaks[b + 1],
                                  static_cast<double>(k) / static_cast<double>(pieces[b])));
    return t;
}

AxisPlaces sampling(const Spline& spline, double chord, double moved) {
    const double part = after_rounding(spline, chord, moved);
    if (!is_function(spline) && !(diagonal(spline.control_points()) > 0)) {
        AxisPlaces one;
        for (const KnotVector& axis : spline.axes()) one.push_back({axis.begin()});
        return one;
    }
    const Spline local = about(spline, centre_of(spline));
    CellCounts cells = enclosing_cells(local, part, same_point_distance(spline));
    if (spline.axis_count() == 3) {
        const CellCounts skin = skin_cells(local, part);
        for (std::size_t k = 0; k < 3; ++k) raise(cells[k], skin[k]);
    }
    double points = 1;
    for (const auto& along : cells) points *= points_along(along);
    return places_of(spline, cells, points, chord);
}

AxisPlaces skin_sampling(const Spline& volume, double chord, double moved) {
    const CellCounts cells =
        skin_cells(about(volume, centre_of(volume)), after_rounding(volume, chord, moved));
    double points = 0;
    for (std::size_t k = 0; k < 3; ++k)
        points += 2 * points_along(cells[(k + 1) % 3]) * points_along(cells[(k + 2) % 3]);
    return places_of(volume, cells, points, chord);
}

std::vector<double> centre_of(const Spline& spline) {
    const PointSet box = bounding_box(spline.control_points());
    std::vector<double> centre;
    for (Index d = 0; d < box.dim(); ++d) centre.push_back(box(0, d) / 2 + box(1, d) / 2);
    return centre;
}

Spline about(const Spline& spline, const std::vector<double>& centre) {
    PointSet control = spline.control_points();
    for (Index i = 0; i < control.size(); ++i)
        for (std::size_t d = 0; d < centre.size(); ++d)
            control(i, static_cast<Index>(d)) -= centre[d];
    return {spline.axes(), std::move(control)};
}

bool meets_itself(const Spline& spline, Index axis) {
    return !is_function(spline) &&
           closes(about(spline, centre_of(spline)), axis, same_point_distance(spline));
}

double same_point_distance(const Spline& spline) {
    return 1e-12 * diagonal(spline.control_points());
}

bool is_same_point(std::span<const double> a, std::span<const double> b, double apart) {
    for (std::size_t d = 0; d < a.size(); ++d)
        if (!(std::abs(a[d] - b[d]) <= apart)) return false;
    return true;
}

double rounding(const Spline& spline, double epsilon) {
    const PointSet box = bounding_box(spline.control_points());
    double largest = 0; // distance of a corner of the box from the origin, squares kept in range
    for (Index d = 0; d < box.dim(); ++d)
        largest = std::hypot(largest, std::max(std::abs(box(0, d)), std::abs(box(1, d))));
    return epsilon * largest;
}

double picture_chord(const Spline& spline, double parts) {
    return std::max({diagonal(spline.control_points()) / parts,
                     4 * rounding(spline, std::numeric_limits<double>::epsilon()), 1e-300});
}

} // namespace batten
