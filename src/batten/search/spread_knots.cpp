#include <batten/search/spread_knots.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/distinct.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

std::vector<std::vector<double>> ascending(const Parameters& parameters) {
    if (!parameters.is_scattered()) return parameters.axes;
    std::vector<std::vector<double>> result(static_cast<std::size_t>(parameters.axis_count()));
    for (Index i = 0; i < parameters.scattered.size(); ++i)
        for (std::size_t k = 0; k < result.size(); ++k)
            result[k].push_back(parameters.scattered(i, static_cast<Index>(k)));
    for (auto& t : result) t = distinct(std::move(t));
    return result;
}

Spread bend_spread(const Samples& samples, const std::vector<double>& t, std::size_t axis,
                   int degree) {
    std::vector<Index> shape = samples.shape();
    const Index m = shape[axis];
    shape.push_back(samples.dim());
    std::vector<double> bend(static_cast<std::size_t>(m), 0);
    std::vector<double> column(static_cast<std::size_t>(m));
    GridIndex(shape).for_each_strand(axis, [&](const GridIndex::Strand& strand) {
        for (Index j = 0; j < m; ++j)
            column[static_cast<std::size_t>(j)] = samples.points.data()[strand[j]];
        for (int order = 0; order <= degree; ++order)
            for (Index j = 0; j + order + 1 < m; ++j)
                column[static_cast<std::size_t>(j)] =
                    column[static_cast<std::size_t>(j + 1)] - column[static_cast<std::size_t>(j)];
        for (Index j = 0; j + degree + 1 < m; ++j) {
            double& to = bend[static_cast<std::size_t>(j + (degree + 1) / 2)];
            to = std::max(to, std::abs(column[static_cast<std::size_t>(j)]));
        }
    });
    for (int pass = 0; pass < 6; ++pass) {
        const std::vector<double> before = bend;
        for (std::size_t j = 1; j + 1 < bend.size(); ++j)
            bend[j] = (before[j - 1] + 2 * before[j] + before[j + 1]) / 4;
    }
    const double largest = *std::max_element(bend.begin(), bend.end());
    Spread sum{0};
    for (std::size_t j = 1; j < t.size();
         ++j) // sample distances cancel: differences already hold h^(p+1)
        sum.push_back(sum.back() +
                      std::pow(largest > 0 ? (bend[j - 1] + bend[j]) / (2 * largest) + 1e-4 : 1.0,
                               1.0 / (degree + 1)));
    for (double& s : sum) s /= sum.back();
    return sum;
}

Spread even_spread(const std::vector<double>& t) {
    Spread sum;
    for (double x : t) sum.push_back((x - t.front()) / (t.back() - t.front()));
    return sum;
}

KnotVector knots_by(const Spread& spread, const std::vector<double>& t, int degree, Index n,
                    Closure closure) {
    const Index count = closure == Closure::closed ? n - 1 : n - degree - 1;
    std::vector<double> interior;
    std::size_t j = 1;
    for (Index k = 1; k <= count; ++k) {
        const double wanted = static_cast<double>(k) / static_cast<double>(count + 1);
        while (j + 1 < spread.size() && spread[j] < wanted) ++j;
        const double part = (wanted - spread[j - 1]) / (spread[j] - spread[j - 1]);
        interior.push_back(t[j - 1] + part * (t[j] - t[j - 1]));
    }
    const bool closed = closure == Closure::closed;
    return knots_around(degree, interior, closed ? 0 : t.front(), closed ? 1 : t.back(), closure);
}

} // namespace batten
