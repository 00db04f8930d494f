#include <batten/basis/nested_knots.hpp>

#include <batten/basis/place_knots.hpp>

#include <algorithm>

namespace batten {

namespace {

/// The knots without those strictly inside the domain that stand for no `step`-th breakpoint.
KnotVector every(Index step, const KnotVector& knots, const std::vector<double>& breaks) {
    const auto all = knots.knots();
    std::vector<double> kept;
    if (knots.closed()) // the seam's copies; one of them is there without being said
        kept.assign(static_cast<std::size_t>(std::ranges::count(all, knots.begin()) - 1),
                    knots.begin());
    for (Index i = step; i + 1 < std::ssize(breaks); i += step) {
        const double t = breaks[static_cast<std::size_t>(i)];
        kept.insert(kept.end(), static_cast<std::size_t>(std::ranges::count(all, t)), t);
    }
    if (knots.closed())
        return knots_around(knots.degree(), kept, knots.begin(), knots.end(), Closure::closed);
    const Index ends = knots.degree() + 1;
    std::vector<double> result(all.begin(), all.begin() + ends);
    result.insert(result.end(), kept.begin(), kept.end());
    result.insert(result.end(), all.end() - ends, all.end());
    return {knots.degree(), std::move(result)};
}

} // namespace

std::vector<KnotVector> nested_knots(const KnotVector& knots) {
    const std::vector<double> breaks = knots.breakpoints();
    const Index spans = std::ssize(breaks) - 1;
    std::vector<KnotVector> result;
    for (Index step = spans; step > 1; --step) {
        if (spans % step != 0) continue;
        try {
            result.push_back(every(step, knots, breaks));
        } catch (const InvalidInput&) { // a closed axis needs some
        }
    }
    result.push_back(knots);
    return result;
}

} // namespace batten
