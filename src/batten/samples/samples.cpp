#include <batten/samples/sample_source.hpp>

#include <batten/core/counts.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace batten {

namespace {

constexpr Index block_size = 1 << 16;
constexpr double smallest_part = 1e-250; // of the largest weight: products with it stay numbers

void check_finite(const Points& points) {
    std::vector<Index> first_bad(static_cast<std::size_t>(block_count(points.size(), block_size)),
                                 -1);
    for_each_block(points.size(), block_size, [&](const Block& block) {
        const double* x = points.data() + block.begin * points.dim();
        const Index count = (block.end - block.begin) * points.dim();
        double probe = 0; // stays zero while all are finite, and the loop vectorises
        for (Index k = 0; k < count; ++k) probe += x[k] * 0.0;
        if (probe == 0) return;
        for (Index k = 0; k < count; ++k)
            if (!std::isfinite(x[k])) {
                first_bad[static_cast<std::size_t>(block.index)] = block.begin + k / points.dim();
                return;
            }
    });
    for (Index i : first_bad)
        if (i >= 0)
            throw InvalidInput(fmt::format("sample {}: its coordinates ({}) must be finite numbers",
                                           i, fmt::join(points[i], ", ")));
}

void check_weights(const Samples& samples) {
    if (samples.weights.empty()) return;
    if (static_cast<Index>(samples.weights.size()) != samples.size())
        throw InvalidInput(fmt::format("weights: {} given for {} samples; one per sample is needed",
                                       samples.weights.size(), samples.size()));
    for (std::size_t i = 0; i < samples.weights.size(); ++i)
        if (!(samples.weights[i] > 0) || !std::isfinite(samples.weights[i]))
            throw InvalidInput(
                fmt::format("weight {}: {} must be positive and finite", i, samples.weights[i]));
    const auto [least, largest] = std::ranges::minmax(samples.weights);
    if (least / largest < smallest_part)
        throw InvalidInput(
            fmt::format("weights: {} and {} are too far apart, the larger must be at "
                        "most {} times the smaller",
                        least, largest, 1 / smallest_part));
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

void check_shape(const Samples& samples) {
    if (samples.size() == 0) throw InvalidInput("samples: there are none");
    if (samples.dim() < 1 || samples.dim() > 16)
        throw InvalidInput(fmt::format("samples: dimension {} is outside 1 to 16", samples.dim()));
    if (samples.grid.empty()) return;
    if (samples.grid.size() < 2 || samples.grid.size() > 3)
        throw InvalidInput(
            fmt::format("grid: {} axes given, 2 or 3 are possible", samples.grid.size()));
    const Index product = checked_product(samples.grid, "grid");
    if (product != samples.size())
        throw InvalidInput(fmt::format("grid: {} needs {} samples, got {}",
                                       fmt::join(samples.grid, "x"), product, samples.size()));
}

void check(const Samples& samples) {
    check_shape(samples);
    check_finite(samples.points);
    check_weights(samples);
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
    const Index dim = points.dim();
    PointSet box(2, dim);
    for (Index d = 0; d < dim; ++d) {
        box(0, d) = std::numeric_limits<double>::infinity();
        box(1, d) = -std::numeric_limits<double>::infinity();
    }
    std::vector<PointSet> partial(static_cast<std::size_t>(block_count(points.size(), block_size)),
                                  box);
    for_each_block(points.size(), block_size, [&](const Block& block) {
        PointSet& mine = partial[static_cast<std::size_t>(block.index)];
        for (Index i = block.begin; i < block.end; ++i)
            for (Index d = 0; d < dim; ++d) {
                mine(0, d) = std::min(mine(0, d), points(i, d));
                mine(1, d) = std::max(mine(1, d), points(i, d));
            }
    });
    for (const PointSet& mine : partial)
        for (Index d = 0; d < dim; ++d) {
            box(0, d) = std::min(box(0, d), mine(0, d));
            box(1, d) = std::max(box(1, d), mine(1, d));
        }
    return box;
}

double diagonal(const Points& points) {
    const PointSet box = bounding_box(points);
    const double plain = distance(box[0], box[1]);
    if (plain > 0 && std::isfinite(plain)) return plain;
    // the squares may have left the range of numbers although the length has not
    double largest = 0;
    for (Index d = 0; d < box.dim(); ++d) largest = std::max(largest, box(1, d) - box(0, d));
    if (!(largest > 0) || !std::isfinite(largest)) return largest;
    double squares = 0;
    for (Index d = 0; d < box.dim(); ++d) {
        const double part = (box(1, d) - box(0, d)) / largest;
        squares += part * part;
    }
    return largest * std::sqrt(squares);
}

} // namespace batten
