#include <batten/samples/samples.hpp>

#include <batten/core/counts.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace batten {

namespace {

constexpr Index chunk_size = 1 << 16;

Index chunks_of(Index count) {
    return (count + chunk_size - 1) / chunk_size;
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

void check_finite(const Points& points) {
    std::vector<Index> first_bad(static_cast<std::size_t>(chunks_of(points.size())), -1);
    for_each_chunk(chunks_of(points.size()), [&](Index chunk) {
        const Index begin = chunk * chunk_size;
        const Index end = std::min(points.size(), begin + chunk_size);
        const double* x = points.data() + begin * points.dim();
        const Index count = (end - begin) * points.dim();
        double probe = 0; // stays zero while all are finite, and the loop vectorises
        for (Index k = 0; k < count; ++k) probe += x[k] * 0.0;
        if (probe == 0) return;
        for (Index k = 0; k < count; ++k)
            if (!std::isfinite(x[k])) {
                first_bad[static_cast<std::size_t>(chunk)] = begin + k / points.dim();
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
}

} // namespace

void check(const Samples& samples) {
    check_shape(samples);
    check_finite(samples.points);
    check_weights(samples);
}

Samples height_samples(const Points& heights, std::array<Index, 2> shape,
                       std::array<double, 2> spacing) {
    if (heights.dim() != 1 || heights.size() != checked_product(shape, "heights"))
        throw InvalidInput(
            fmt::format("heights: {}x{} needs {} single numbers, got {} of dimension {}", shape[0],
                        shape[1], shape[0] * shape[1], heights.size(), heights.dim()));
    for (double s : spacing)
        if (!(s > 0) || !std::isfinite(s))
            throw InvalidInput(fmt::format("spacing: {} must be positive and finite", s));
    PointSet points(heights.size(), 3);
    for (Index i = 0; i < shape[0]; ++i)
        for (Index j = 0; j < shape[1]; ++j) {
            const Index k = i * shape[1] + j;
            points(k, 0) = static_cast<double>(i) * spacing[0];
            points(k, 1) = static_cast<double>(j) * spacing[1];
            points(k, 2) = heights(k, 0);
        }
    return {.points = std::move(points), .grid = {shape[0], shape[1]}};
}

std::vector<Index> end_samples(const Samples& samples) {
    std::vector<Index> ends{0};
    for (Index m : samples.shape()) {
        std::vector<Index> next;
        for (Index i : ends)
            for (Index end : {Index{0}, m - 1}) next.push_back(i * m + end);
        ends = std::move(next);
    }
    return ends;
}

PointSet bounding_box(const Points& points) {
    const Index dim = points.dim();
    PointSet box(2, dim);
    for (Index d = 0; d < dim; ++d) {
        box(0, d) = std::numeric_limits<double>::infinity();
        box(1, d) = -std::numeric_limits<double>::infinity();
    }
    std::vector<PointSet> partial(static_cast<std::size_t>(chunks_of(points.size())), box);
    for_each_chunk(chunks_of(points.size()), [&](Index chunk) {
        PointSet& mine = partial[static_cast<std::size_t>(chunk)];
        const Index end = std::min(points.size(), (chunk + 1) * chunk_size);
        for (Index i = chunk * chunk_size; i < end; ++i)
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
