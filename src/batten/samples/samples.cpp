#include <batten/samples/sample_source.hpp>

#include <batten/core/counts.hpp>
#include <batten/samples/scan.hpp>

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

void check_weights(const Samples& samples) {
    if (samples.weights.empty()) return;
    WeightScan scan;
    scan.add(samples.weights);
    scan.check_range();
}

} // namespace

std::string_view to_string(SampleKind kind) {
    constexpr std::string_view names[] = {"sequence", "grid", "cloud"};
    return names[static_cast<std::size_t>(kind)];
}

void check_sample(std::string_view what, Index i, Index samples) {
    if (i < 0 || i >= samples)
        throw InvalidInput(fmt::format("{} {}: the samples are 0 to {}", what, i, samples - 1));
}

void check_extent(Index samples, Index dim) {
    if (samples == 0) throw InvalidInput("samples: there are none");
    if (dim < 1 || dim > 16)
        throw InvalidInput(fmt::format("samples: dimension {} is outside 1 to 16", dim));
}

void check_shape(const Samples& samples) {
    check_extent(samples.size(), samples.dim());
    if (!samples.weights.empty() && static_cast<Index>(samples.weights.size()) != samples.size())
        throw InvalidInput(fmt::format("weights: {} given for {} samples; one per sample is needed",
                                       samples.weights.size(), samples.size()));
    if (samples.grid.empty()) return;
    if (samples.grid.size() < 2 || samples.grid.size() > 3)
        throw InvalidInput(
            fmt::format("grid: {} axes given, 2 or 3 are possible", samples.grid.size()));
    const Index product = checked_product(samples.grid, "grid");
    if (product != samples.size())
        throw InvalidInput(fmt::format("grid: {} needs {} samples, got {}",
                                       fmt::join(samples.grid, "x"), product, samples.size()));
}

void check(const Samples& samples, const PointScan& scan) {
    check_shape(samples);
    if (const Index bad = scan.first_bad(); bad >= 0) throw not_finite(bad, samples.points[bad]);
    check_weights(samples);
}

void check(const Samples& samples) {
    check(samples, scanned(samples.points));
}

Samples height_samples(const Points& heights, std::array<Index, 2> shape,
                       std::array<double, 2> spacing) {
    const GridIndex grid(shape);
    if (heights.dim() != 1 || heights.size() != grid.size())
        throw InvalidInput(
            fmt::format("heights: {}x{} needs {} single numbers, got {} of dimension {}", shape[0],
                        shape[1], grid.size(), heights.size(), heights.dim()));
    for (double s : spacing)
        if (!(s > 0) || !std::isfinite(s))
            throw InvalidInput(fmt::format("spacing: {} must be positive and finite", s));
    PointSet points(heights.size(), 3);
    grid.for_each([&](const GridIndex::Place& place, Index i) {
        for (std::size_t k = 0; k < 2; ++k)
            points(i, static_cast<Index>(k)) = static_cast<double>(place[k]) * spacing[k];
        points(i, 2) = heights(i, 0);
    });
    return {.points = std::move(points),
            .grid = {shape[0], shape[1]},
            .weights = {},
            .order = Order::along_curve,
            .spacing = Spacing::even};
}

std::vector<Index> end_samples(const Samples& samples) {
    const GridIndex grid(samples.shape());
    std::vector<Index> ends;
    GridIndex(std::vector<Index>(grid.axis_count(), 2))
        .for_each([&](GridIndex::Place corner, Index) {
            for (std::size_t k = 0; k < grid.axis_count(); ++k) corner[k] *= grid.length(k) - 1;
            ends.push_back(grid.at(corner));
        });
    return ends;
}

PointSet bounding_box(const Points& points) {
    return scanned(points).box();
}

double diagonal(const Points& points) {
    return diagonal_of(bounding_box(points));
}

} // namespace batten
