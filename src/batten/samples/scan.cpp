#include <batten/samples/scan.hpp>

#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

constexpr Index block_size = 1 << 14;
constexpr double smallest_part = 1e-250; // of the largest weight: products with it stay numbers
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Least and largest of `groups` groups of eight points; `probe` stays zero while all are finite.
template <int known_dim>
inline __attribute__((always_inline)) void scan_groups(const double* x, Index groups, Index dim_,
                                                       Lanes* least, Lanes* largest, Lanes* probe) {
    constexpr int room = known_dim > 0 ? known_dim : 16;
    const Index dim = known_dim > 0 ? known_dim : dim_;
    LaneVector low[room];
    LaneVector high[room];
    for (Index d = 0; d < dim; ++d) {
        low[d] = load(least[d].value.data());
        high[d] = load(largest[d].value.data());
    }
    LaneVector off = load(probe->value.data());
    for (Index g = 0; g < groups; ++g)
        for (Index d = 0; d < dim; ++d) {
            const LaneVector v = load(x + (g * dim + d) * lanes);
            low[d] = v < low[d] ? v : low[d];
            high[d] = v > high[d] ? v : high[d];
            off += v - v;
        }
    for (Index d = 0; d < dim; ++d) {
        store(low[d], least[d].value.data());
        store(high[d], largest[d].value.data());
    }
    store(off, probe->value.data());
}

BATTEN_VECTOR_CLONES
void scan_points(const double* x, Index groups, Index dim, Lanes* least, Lanes* largest,
                 Lanes* probe) {
    switch (dim) {
    case 1:
        return scan_groups<1>(x, groups, dim, least, largest, probe);
    case 2:
        return scan_groups<2>(x, groups, dim, least, largest, probe);
    case 3:
        return scan_groups<3>(x, groups, dim, least, largest, probe);
    default:
        return scan_groups<0>(x, groups, dim, least, largest, probe);
    }
}

BATTEN_VECTOR_CLONES
void scan_weights(const double* w, Index groups, Lanes* least, Lanes* largest, Lanes* probe) {
    scan_groups<1>(w, groups, 1, least, largest, probe);
}

Lanes filled(double value) {
    Lanes all;
    all.value.fill(value);
    return all;
}

} // namespace

PointScan::PointScan(Index dim)
    : dim_(dim),
      least_(static_cast<std::size_t>(dim), filled(infinite)),
      largest_(static_cast<std::size_t>(dim), filled(-infinite)) {}

void PointScan::clear() {
    count_ = 0;
    first_bad_ = -1;
    std::ranges::fill(least_, filled(infinite));
    std::ranges::fill(largest_, filled(-infinite));
}

void PointScan::add(const double* points, Index count) {
    Lanes probe;
    const Index groups = dim_ <= 16 ? count / lanes : 0; // it has room for so many coordinates
    if (groups > 0) scan_points(points, groups, dim_, least_.data(), largest_.data(), &probe);
    for (Index k = groups * lanes * dim_; k < count * dim_; ++k) {
        const double x = points[k];
        const Index at = k % (lanes * dim_);
        const auto vector = static_cast<std::size_t>(at / lanes);
        const auto lane = static_cast<std::size_t>(at % lanes);
        least_[vector].value[lane] = std::min(least_[vector].value[lane], x);
        largest_[vector].value[lane] = std::max(largest_[vector].value[lane], x);
        probe.value[lane] += x - x;
    }
    if (probe.sum() != 0 && first_bad_ < 0)
        for (Index k = 0; k < count * dim_; ++k)
            if (!std::isfinite(points[k])) {
                first_bad_ = count_ + k / dim_;
                break;
            }
    count_ += count;
}

void PointScan::add(const PointScan& next) {
    if (first_bad_ < 0 && next.first_bad_ >= 0) first_bad_ = count_ + next.first_bad_;
    count_ += next.count_;
    for (std::size_t v = 0; v < least_.size(); ++v)
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            double& low = least_[v].value[lane];
            double& high = largest_[v].value[lane];
            low = std::min(low, next.least_[v].value[lane]);
            high = std::max(high, next.largest_[v].value[lane]);
        }
}

PointSet PointScan::box() const {
    PointSet box(2, dim_);
    for (Index d = 0; d < dim_; ++d) {
        box(0, d) = infinite;
        box(1, d) = -infinite;
    }
    for (Index k = 0; k < lanes * dim_; ++k) {
        const auto vector = static_cast<std::size_t>(k / lanes);
        const auto lane = static_cast<std::size_t>(k % lanes);
        box(0, k % dim_) = std::min(box(0, k % dim_), least_[vector].value[lane]);
        box(1, k % dim_) = std::max(box(1, k % dim_), largest_[vector].value[lane]);
    }
    return box;
}

PointScan scanned(const Points& points) {
    PointScan whole(points.dim());
    std::vector<PointScan> parts(static_cast<std::size_t>(block_count(points.size(), block_size)),
                                 whole);
    for_each_block(points.size(), block_size, [&](const Block& block) {
        parts[static_cast<std::size_t>(block.index)].add(points.data() + block.begin * points.dim(),
                                                         block.end - block.begin);
    });
    for (const PointScan& part : parts) whole.add(part);
    return whole;
}

InvalidInput not_finite(Index sample, std::span<const double> point) {
    return InvalidInput(fmt::format("sample {}: its coordinates ({}) must be finite numbers",
                                    sample, fmt::join(point, ", ")));
}

void WeightScan::add(std::span<const double> weights) {
    Lanes least = filled(infinite);
    Lanes largest = filled(0);
    Lanes probe;
    const auto groups = static_cast<Index>(weights.size()) / lanes;
    scan_weights(weights.data(), groups, &least, &largest, &probe);
    for (std::size_t k = static_cast<std::size_t>(groups * lanes); k < weights.size(); ++k) {
        least.value[0] = std::min(least.value[0], weights[k]);
        largest.value[0] = std::max(largest.value[0], weights[k]);
        probe.value[0] += weights[k] - weights[k];
    }
    const double lowest = *std::ranges::min_element(least.value);
    if (!(lowest > 0) || probe.sum() != 0)
        for (std::size_t k = 0; k < weights.size(); ++k)
            if (!(weights[k] > 0) || !std::isfinite(weights[k]))
                throw InvalidInput(fmt::format("weight {}: {} must be positive and finite",
                                               count_ + static_cast<Index>(k), weights[k]));
    least_ = std::min(least_, lowest);
    largest_ = std::max(largest_, *std::ranges::max_element(largest.value));
    count_ += static_cast<Index>(weights.size());
}

void WeightScan::check_range() const {
    if (least_ / largest_ < smallest_part)
        throw InvalidInput(
            fmt::format("weights: {} and {} are too far apart, the larger must be at "
                        "most {} times the smaller",
                        least_, largest_, 1 / smallest_part));
}

double usual_unit(const PointSet& box) {
    constexpr int far = 200;
    double largest = 0;
    for (const double x : box.values()) largest = std::max(largest, std::abs(x));
    if (!(largest > 0) || !std::isfinite(largest)) return 1;
    const int exponent = std::ilogb(largest);
    return std::abs(exponent) <= far ? 1 : std::ldexp(1.0, -exponent);
}

double diagonal_of(const PointSet& box) {
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
