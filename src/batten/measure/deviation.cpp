#include <batten/measure/deviation.hpp>

#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>
#include <batten/measure/curve_deviation.hpp>
#include <batten/measure/grid_deviation.hpp>
#include <batten/samples/passes.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index block_size = 4096;

BATTEN_VECTOR_CLONES
void add_squares(const double* x, Index count, Lanes* squares, Lanes* largest) {
    LaneVector sum = load(squares->value.data());
    LaneVector most = load(largest->value.data());
    for (Index k = 0; k < count; k += lanes) {
        const LaneVector v = load(x + k);
        sum += v * v;
        most = v > most ? v : most;
    }
    store(sum, squares->value.data());
    store(most, largest->value.data());
}

/// Of a cloud, some samples at a time.
std::vector<double> scattered_deviations(const Spline& spline, const Points& points,
                                         const Points& parameters) {
    std::vector<double> result(static_cast<std::size_t>(points.size()));
    for_each_block(points.size(), block_size, [&](const Block& block) {
        const PointSet values =
            evaluate(spline, parameters.slice(block.begin, block.end - block.begin));
        for (Index i = block.begin; i < block.end; ++i)
            result[static_cast<std::size_t>(i)] = distance(values[i - block.begin], points[i]);
    });
    return result;
}

} // namespace

std::string_view to_string(DeviationKind kind) {
    return kind == DeviationKind::parametric ? "parametric" : "distance";
}

std::vector<double> parametric_deviations(const Spline& spline, const Samples& samples,
                                          const Parameters& parameters) {
    if (parameters.is_scattered())
        return scattered_deviations(spline, samples.points, parameters.scattered);
    if (parameters.axes.size() > 1) {
        std::vector<double> result(static_cast<std::size_t>(samples.size()));
        grid_deviation(spline, samples.points, parameters.axes, result.data());
        return result;
    }
    return curve_deviations(spline, samples.points, parameters.axes[0]);
}

std::vector<double> deviations(const Spline& spline, const Samples& samples,
                               const Parameters& parameters, DeviationKind kind) {
    return kind == DeviationKind::distance ? closest_distances(spline, samples, parameters)
                                           : parametric_deviations(spline, samples, parameters);
}

DeviationPart measured(std::span<const double> deviations) {
    Lanes squares;
    Lanes largest;
    const auto count = static_cast<Index>(deviations.size());
    const Index whole = count / lanes * lanes;
    add_squares(deviations.data(), whole, &squares, &largest);
    for (Index k = whole; k < count; ++k) {
        const double x = deviations[static_cast<std::size_t>(k)];
        const auto lane = static_cast<std::size_t>(k - whole);
        squares.value[lane] += x * x;
        largest.value[lane] = std::max(largest.value[lane], x);
    }
    return {squares.sum(), *std::ranges::max_element(largest.value)};
}

void DeviationSum::add(const DeviationPart& part, std::span<const double> deviations) {
    squares_ += part.squares;
    if (part.maximum > maximum_) {
        maximum_ = part.maximum;
        worst_ = count_ + (std::ranges::find(deviations, maximum_) - deviations.begin());
    }
    count_ += static_cast<Index>(deviations.size());
}

Deviation DeviationSum::deviation(DeviationKind kind) const {
    return {.maximum = maximum_,
            .rms = std::sqrt(squares_ / static_cast<double>(std::max<Index>(1, count_))),
            .worst_sample = worst_,
            .kind = kind};
}

Deviation summarise(const std::vector<double>& deviations, DeviationKind kind) {
    const auto count = static_cast<Index>(deviations.size());
    const auto chunk = [&](const Block& block) {
        return std::span(deviations)
            .subspan(static_cast<std::size_t>(block.begin),
                     static_cast<std::size_t>(block.end - block.begin));
    };
    std::vector<DeviationPart> parts(static_cast<std::size_t>(block_count(count, chunk_samples)));
    for_each_block(count, chunk_samples, [&](const Block& block) {
        parts[static_cast<std::size_t>(block.index)] = measured(chunk(block));
    });
    DeviationSum sum;
    for (Index k = 0; k < static_cast<Index>(parts.size()); ++k)
        sum.add(parts[static_cast<std::size_t>(k)],
                chunk({k, k * chunk_samples, std::min(count, (k + 1) * chunk_samples)}));
    return sum.deviation(kind);
}

} // namespace batten
