#include <batten/samples/curvature.hpp>

#include <batten/core/vectors.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// Distance of p from the line through a and b.
double off_line(std::span<const double> p, std::span<const double> a, std::span<const double> b) {
    const std::vector<double> ab = difference(b, a);
    const std::vector<double> ap = difference(p, a);
    const double length = dot(ab, ab);
    if (length == 0) return norm(ap);
    const double along = dot(ap, ab);
    return std::sqrt(std::max(0.0, dot(ap, ap) - along * along / length));
}

/// Points to either side over which the sequence bends by less than a tenth of the chord.
Index support(const Points& sequence, Index j, Index widest) {
    constexpr double bend = 0.1;
    Index w = 0;
    while (w < widest && j - w - 1 >= 0 && j + w + 1 < sequence.size()) {
        const auto a = sequence[j - w - 1];
        const auto b = sequence[j + w + 1];
        if (off_line(sequence[j], a, b) > bend * distance(a, b)) break;
        ++w;
    }
    return w;
}

PointSet smoothed(const Points& sequence, Index widest) {
    PointSet result(sequence);
    for (Index j = 0; j < sequence.size(); ++j) {
        const Index w = support(sequence, j, widest);
        if (w == 0) continue;
        const double sigma = static_cast<double>(w) / 2;
        double total = 0;
        for (double& x : result[j]) x = 0;
        for (Index k = -w; k <= w; ++k) {
            const double weight = std::exp(-static_cast<double>(k * k) / (2 * sigma * sigma));
            total += weight;
            for (Index d = 0; d < result.dim(); ++d) result(j, d) += weight * sequence(j + k, d);
        }
        for (double& x : result[j]) x /= total;
    }
    return result;
}

/// How large |a x b| of first and second differences can be of straight samples with this error.
double unsure(const std::vector<double>& a, const std::vector<double>& b, double error) {
    const double rounding = 8 * std::sqrt(std::numeric_limits<double>::epsilon());
    return norm(a) * (4 * error + rounding * norm(b));
}

} // namespace

std::vector<double> discrete_curvature(const Points& sequence, Index widest, double error) {
    const PointSet p = smoothed(sequence, widest);
    const Index m = p.size();
    std::vector<double> curvature(static_cast<std::size_t>(m));
    for (Index j = 1; j + 1 < m; ++j) {
        std::vector<double> first = difference(p[j + 1], p[j - 1]);
        for (double& x : first) x /= 2;
        std::vector<double> second(first.size());
        for (std::size_t d = 0; d < second.size(); ++d)
            second[d] = p[j + 1][d] - 2 * p[j][d] + p[j - 1][d];
        // |a x b|^2 = |a|^2 |b|^2 - (a.b)^2 in any dimension
        const double square = dot(first, first);
        const double cross = square * dot(second, second) - dot(first, second) * dot(first, second);
        const double area = std::sqrt(std::max(0.0, cross));
        if (square > 0 && (error == 0 || area > unsure(first, second, error)))
            curvature[static_cast<std::size_t>(j)] = area / std::pow(square, 1.5);
    }
    if (m > 2) {
        curvature.front() = curvature[1];
        curvature.back() = curvature[static_cast<std::size_t>(m - 2)];
    }
    return curvature;
}

std::vector<Index> dominant_indices(const std::vector<double>& k) {
    constexpr double rounding = 1e-6; // on a circle all curvatures are equal but for it
    std::vector<Index> result{0};
    for (std::size_t j = 1; j + 1 < k.size(); ++j) // eq. 31 prints k < k < k for a local maximum
        if (k[j - 1] * (1 + rounding) < k[j] && k[j] >= k[j + 1])
            result.push_back(static_cast<Index>(j));
    result.push_back(static_cast<Index>(k.size()) - 1);
    return result;
}

std::vector<Index> dominant_indices(const std::vector<double>& k, double rise) {
    std::vector<Index> result{0};
    std::size_t low = 0; // the last minimum, then the maximum after it
    std::size_t high = 0;
    bool rising = false;
    for (std::size_t j = 1; j < k.size(); ++j) {
        if (rising ? k[j] > k[high] : k[j] < k[low]) (rising ? high : low) = j;
        if (rising && k[high] - k[j] > rise) {
            result.push_back(static_cast<Index>(high));
            low = j;
            rising = false;
        } else if (!rising && k[j] - k[low] > rise) {
            high = j;
            rising = true;
        }
    }
    result.push_back(static_cast<Index>(k.size()) - 1);
    return result;
}

double span_of_noise(const std::vector<double>& values) {
    const double most = std::sqrt(2 * std::log(static_cast<double>(values.size())));
    return 2 * most * usual_noise(PointSet(values, 1));
}

} // namespace batten
