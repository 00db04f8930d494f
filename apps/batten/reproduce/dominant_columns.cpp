#include "dominant_columns.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/core/grid_index.hpp>
#include <batten/core/stopwatch.hpp>

#include <algorithm>

namespace batten::command {

namespace {

using Lines = std::vector<std::vector<Index>>; ///< dominant rows, dominant columns

/// EPIA's first control points are the samples where dominant rows and columns cross.
Lines dominant_lines(const Samples& grid, const std::vector<Index>& shape) {
    FitOptions options;
    options.method = {.name = "epia", .settings = {{"rounds", 0}}};
    options.shape.control_points = shape;
    options.stop.max_iterations = 0;
    const Spline spline = fit(grid, options).spline;
    const PointSet& net = spline.control_points();
    const GridIndex at(spline.control_shape());
    Lines lines;
    for (std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
        lines.emplace_back();
        const Index stride = GridIndex(grid.grid).stride(axis);
        Index sample = 0;
        for (Index i = 0; i < at.length(axis); ++i, ++sample) {
            const auto own = net[i * at.stride(axis)];
            while (!std::ranges::equal(grid.points[sample * stride], own)) ++sample;
            lines.back().push_back(sample);
        }
    }
    return lines;
}

FitResult least_squares(const Samples& grid, const Parameters& parameters, const Lines& lines) {
    FitOptions options;
    options.method.name = "direct";
    options.shape.parameters = parameters;
    for (std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
        std::vector<double> own;
        for (Index i : lines[axis])
            own.push_back(parameters.axes[axis][static_cast<std::size_t>(i)]);
        const KnotVector knots = averaged_knots(own, 3);
        options.shape.knots.emplace_back(knots.knots().begin(), knots.knots().end());
    }
    return fit(grid, options);
}

/// Makes a sample's row or column dominant; false when both are.
bool insert(Lines& lines, const GridIndex::Place& place) {
    std::size_t best = 2;
    Index widest = 0;
    for (std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
        const auto after = std::ranges::lower_bound(lines[axis], place[axis]);
        if (*after == place[axis]) continue;
        const Index gap = *after - *(after - 1);
        if (gap > widest) best = axis;
        widest = std::max(widest, gap);
    }
    if (best == 2) return false;
    lines[best].insert(std::ranges::lower_bound(lines[best], place[best]), place[best]);
    return true;
}

} // namespace

RepeatedLeastSquares repeated_least_squares(const Samples& grid, const std::vector<Index>& shape,
                                            Index iterations) {
    Stopwatch watch;
    Lines lines = dominant_lines(grid, shape);
    const Parameters parameters =
        parametrize(grid, Parametrization::chord, {Closure::open, Closure::open});
    FitResult first = least_squares(grid, parameters, lines);
    FitResult now = first;
    for (Index k = 0; k < iterations; ++k) {
        std::vector<std::pair<double, Index>> worst;
        for (Index j = 0; j < grid.size(); ++j)
            worst.emplace_back(-now.deviations[static_cast<std::size_t>(j)], j);
        std::ranges::sort(worst);
        for (const auto& [far, sample] : worst)
            if (insert(lines, GridIndex(grid.grid).place(sample))) break;
        now = least_squares(grid, parameters, lines);
    }
    return {std::move(first), std::move(now), watch.lap()};
}

} // namespace batten::command
