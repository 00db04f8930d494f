#include <batten/io/sampling.hpp>

#include <batten/samples/samples.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr double most_points = 1e7;

/// `pieces` equal parts of every span.
std::vector<double> divided(const std::vector<double>& breaks, const std::vector<Index>& pieces) {
    std::vector<double> t{breaks.front()};
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        for (Index k = 1; k <= pieces[b]; ++k)
            t.push_back(breaks[b] + (breaks[b + 1] - breaks[b]) * static_cast<double>(k) /
                                        static_cast<double>(pieces[b]));
    return t;
}

/// Pieces of each span of an axis from the largest second derivative there: the height of an arc
/// over a step h is h^2 / 8 of it.
std::vector<Index> pieces_of(const Spline& spline, std::size_t axis, double chord) {
    std::vector<std::vector<double>> places;
    for (const KnotVector& knots : spline.axes()) {
        const auto breaks = knots.breakpoints();
        places.push_back(divided(breaks, std::vector<Index>(breaks.size() - 1, 3)));
    }
    std::vector<int> orders(places.size(), 0);
    orders[axis] = 2;
    const PointSet second = evaluate_grid(spline, places, orders);
    const std::vector<double> breaks = spline.axes()[axis].breakpoints();
    std::vector<double> bend(breaks.size() - 1, 0);
    Index inner = 1;
    for (std::size_t k = axis + 1; k < places.size(); ++k)
        inner *= static_cast<Index>(places[k].size());
    const auto along = static_cast<Index>(places[axis].size());
    for (Index i = 0; i < second.size(); ++i) {
        double square = 0;
        for (double x : second[i]) square += x * x;
        const auto at = static_cast<std::size_t>(i / inner % along);
        for (std::size_t span : {at / 3, (at + 2) / 3 - (at > 0 ? 1 : 0)})
            if (span < bend.size()) bend[span] = std::max(bend[span], std::sqrt(square));
    }
    std::vector<Index> pieces;
    for (std::size_t b = 0; b < bend.size(); ++b) {
        const double h = breaks[b + 1] - breaks[b];
        const double needed = std::ceil(h * std::sqrt(bend[b] / (8 * chord)));
        pieces.push_back(static_cast<Index>(std::clamp(needed, 1.0, most_points)));
    }
    return pieces;
}

} // namespace

std::vector<std::vector<double>> sampling(const Spline& spline, double chord) {
    if (!(chord > 0) || !std::isfinite(chord))
        throw InvalidInput(fmt::format("chord tolerance {}: must be positive and finite", chord));
    std::vector<std::vector<double>> result;
    double total = 1;
    // of a surface each direction, and the twist between them, gets a part
    const double part = spline.axis_count() == 1 ? 1 : 1.0 / 3;
    for (std::size_t k = 0; k < spline.axes().size(); ++k) {
        const std::vector<Index> pieces = pieces_of(spline, k, part * chord);
        double along = 1;
        for (Index n : pieces) along += static_cast<double>(n);
        total *= along;
        if (total > most_points)
            throw InvalidInput(fmt::format(
                "chord tolerance {}: more than {:.0e} points would be needed", chord, most_points));
        result.push_back(divided(spline.axes()[k].breakpoints(), pieces));
    }
    return result;
}

double picture_chord(const Spline& spline) {
    return std::max(diagonal(spline.control_points()) / 1000, 1e-300);
}

} // namespace batten
