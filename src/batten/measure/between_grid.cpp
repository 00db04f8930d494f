#include <batten/measure/between_samples.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

namespace batten {

namespace {

/// A grid of samples and how it bends.
struct Grid {
    const Points& points;
    GridIndex index;
    std::array<bool, 3> closed{false, false, false};
    std::array<std::vector<double>, 3> bend{}; ///< per axis |second difference| / 4 at each sample
};

constexpr Index block_size = 4096;

void measure_bends(Grid& grid, std::size_t axis) {
    const Index m = grid.index.length(axis);
    const Index stride = grid.index.stride(axis);
    auto& bend = grid.bend[axis];
    bend.assign(static_cast<std::size_t>(grid.points.size()), 0);
    if (m < 3) return;
    const Index dim = grid.points.dim();
    for_each_block(grid.points.size(), block_size, [&](const Block& block) {
        for (Index s = block.begin; s < block.end; ++s) {
            Index middle = s / stride % m;
            Index shift = 0; // an end's second difference is its neighbour's
            if (!grid.closed[axis]) shift = middle == 0 ? 1 : middle == m - 1 ? -1 : 0;
            const Index i = s + shift * stride;
            middle += shift;
            const Index before = middle > 0 ? i - stride : i + (m - 1) * stride;
            const Index after = middle + 1 < m ? i + stride : i - (m - 1) * stride;
            double square = 0;
            for (Index d = 0; d < dim; ++d) {
                const double second =
                    grid.points(before, d) - 2 * grid.points(i, d) + grid.points(after, d);
                square += second * second;
            }
            bend[static_cast<std::size_t>(s)] = std::sqrt(square) / 4;
        }
    });
}

/// Parameters of the samples and of the places half-way, alternating; a closed axis goes on to its
/// first sample.
std::vector<double> with_halves(const std::vector<double>& t, bool closed, double length) {
    std::vector<double> result;
    for (std::size_t i = 0; i < t.size(); ++i) {
        result.push_back(t[i]);
        if (i + 1 < t.size())
            result.push_back((t[i] + t[i + 1]) / 2);
        else if (closed)
            result.push_back((t[i] + t.front() + length) / 2);
    }
    return result;
}

/// Excess of the spline's point at the half-grid place `h` (even: a sample's, odd: between two).
double excess_at(const Grid& grid, const GridIndex::Place& h, std::span<const double> point,
                 const std::vector<double>& tolerance) {
    std::array<std::array<Index, 2>, 3> side{};
    Index corners = 1;
    for (std::size_t k = 0; k < 3; ++k) {
        side[k] = {h[k] / 2, (h[k] + 1) / 2 % grid.index.length(k)};
        corners *= h[k] % 2 == 1 ? 2 : 1;
    }
    std::array<double, 16> mean{};
    std::array<double, 3> bend{};
    double t = 0;
    for (Index a = 0; a <= h[0] % 2; ++a)
        for (Index b = 0; b <= h[1] % 2; ++b)
            for (Index c = 0; c <= h[2] % 2; ++c) {
                const auto s = static_cast<std::size_t>(grid.index.at(
                    {side[0][static_cast<std::size_t>(a)], side[1][static_cast<std::size_t>(b)],
                     side[2][static_cast<std::size_t>(c)]}));
                t = std::max(t, tolerance[s]);
                for (std::size_t k = 0; k < 3; ++k)
                    if (h[k] % 2 == 1) bend[k] = std::max(bend[k], grid.bend[k][s]);
                const auto q = grid.points[static_cast<Index>(s)];
                for (std::size_t d = 0; d < q.size(); ++d)
                    mean[d] += q[d] / static_cast<double>(corners);
            }
    const double off = distance({mean.data(), point.size()}, point);
    return off / std::max(2 * t, t + bend[0] + bend[1] + bend[2]);
}

} // namespace

BetweenSamples check_between_grid(const Spline& spline, const Samples& samples,
                                  const Parameters& parameters,
                                  const std::vector<double>& tolerance) {
    Grid grid{.points = samples.points, .index = GridIndex(samples.grid)};
    std::vector<std::vector<double>> halves;
    for (std::size_t k = 0; k < samples.grid.size(); ++k) {
        grid.closed[k] = spline.axes()[k].closed();
        measure_bends(grid, k);
        halves.push_back(
            with_halves(parameters.axes[k], grid.closed[k], spline.axes()[k].length()));
    }
    BetweenSamples result;
    std::mutex merging;
    constexpr Index slab = 16;
    for_each_block(static_cast<Index>(halves[0].size()), slab, [&](const Block& block) {
        Parameters part{halves, {}};
        part.axes[0].assign(halves[0].begin() + block.begin, halves[0].begin() + block.end);
        const PointSet points = evaluate_grid(spline, part.axes);
        BetweenSamples mine;
        part.grid().for_each([&](GridIndex::Place h, Index at) {
            h[0] += block.begin;
            if (h[0] % 2 + h[1] % 2 + h[2] % 2 == 0) return; // a sample itself
            const double excess = excess_at(grid, h, points[at], tolerance);
            if (excess <= mine.excess) return;
            mine.excess = excess;
            mine.worst_sample = grid.index.at({h[0] / 2, h[1] / 2, h[2] / 2});
        });
        const std::lock_guard lock(merging);
        const bool greater = mine.excess > result.excess;
        const bool earlier =
            mine.excess == result.excess && mine.worst_sample < result.worst_sample;
        if (greater || earlier) result = mine;
    });
    result.good = result.excess <= 1;
    return result;
}

} // namespace batten
