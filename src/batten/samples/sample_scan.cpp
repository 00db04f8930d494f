#include <batten/samples/sample_scan.hpp>

#include <cmath>

namespace batten {

void SampleScan::add(const SampleChunk& chunk, const PointScan& points) {
    if (const Index bad = points.first_bad(); bad >= 0)
        throw not_finite(chunk.first + bad, Points(chunk.points, chunk.count, box_.dim())[bad]);
    box_.add(points);
    if (chunk.weights != nullptr)
        weights_.add({chunk.weights, static_cast<std::size_t>(chunk.count)});
}

void SampleScan::check(Index samples) const {
    check_extent(samples, box_.dim());
    if (weights_.largest() > 0) weights_.check_range();
}

bool SampleScan::usual_numbers() const {
    constexpr int far = 200;
    const int exponent = weights_.largest() > 0 ? std::ilogb(weights_.largest()) : 0;
    // weights that differ count by their ratios: the largest is from 1 to 2, or is to be made so
    return std::abs(exponent) <= (weighted() ? 0 : far) && usual_unit(box_.box()) == 1;
}

} // namespace batten
