#include <batten/system/chebyshev_maps.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace batten {

namespace {

constexpr int most_nodes = max_degree + 1;

/// Chebyshev nodes of n points and the matrix that turns values there into coefficients, for every
/// n needed.
struct Transform {
    std::array<double, most_nodes> node{};
    std::array<std::array<double, most_nodes>, most_nodes> matrix{};
};

const Transform& transform(int n) {
    static const auto all = [] {
        std::array<Transform, most_nodes + 1> result{};
        for (int size = 1; size <= most_nodes; ++size)
            for (int j = 0; j < size; ++j) {
                const double angle = std::numbers::pi * (j + 0.5) / size;
                result[static_cast<std::size_t>(size)].node[static_cast<std::size_t>(j)] =
                    std::cos(angle);
                for (int k = 0; k < size; ++k)
                    result[static_cast<std::size_t>(size)]
                        .matrix[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] =
                        (k == 0 ? 1.0 : 2.0) / size * std::cos(k * angle);
            }
        return result;
    }();
    return all[static_cast<std::size_t>(n)];
}

} // namespace

ChebyshevMaps::ChebyshevMaps(const KnotVector& knots, Index span)
    : p_(knots.degree()),
      middle_((knots[span] + knots[span + 1]) / 2),
      scale_(2 / (knots[span + 1] - knots[span])) {
    std::fill_n(values_.begin(), (p_ + 1) * (p_ + 1), 0.0);
    const int n = p_ + 1;
    const Transform& t = transform(n);
    for (int j = 0; j < n; ++j) {
        const auto node = static_cast<std::size_t>(j);
        const BasisValues b = basis_values(knots, span, middle_ + t.node[node] / scale_);
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < n; ++k)
                values_[static_cast<std::size_t>(i * n + k)] +=
                    t.matrix[static_cast<std::size_t>(k)][node] * b[static_cast<std::size_t>(i)];
    }
}

ChebyshevPairs::ChebyshevPairs(const KnotVector& knots, Index span) : ChebyshevMaps(knots, span) {
    std::fill_n(pairs_.begin(), (p_ + 1) * (p_ + 2) / 2 * (2 * p_ + 1), 0.0);
    const int n = p_ + 1;
    // T_a T_b = (T_{a+b} + T_{|a-b|}) / 2
    for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) {
            double* row = pairs_.data() + pair_row(i, j, p_) * (2 * p_ + 1);
            for (int a = 0; a < n; ++a)
                for (int b = 0; b < n; ++b) {
                    const double half = coefficients(i)[a] * coefficients(j)[b] / 2;
                    row[a + b] += half;
                    row[a > b ? a - b : b - a] += half;
                }
        }
}

} // namespace batten
