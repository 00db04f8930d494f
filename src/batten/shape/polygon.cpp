#include <batten/shape/polygon.hpp>

#include <algorithm>

namespace batten {

double turn(std::span<const double> a, std::span<const double> b, std::span<const double> c) {
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

namespace {

/// Indices of the points left when each run of equal ones counts once.
std::vector<Index> distinct(const PointSet& polygon, Closure closure) {
    std::vector<Index> kept;
    for (Index i = 0; i < polygon.size(); ++i)
        if (kept.empty() || !std::ranges::equal(polygon[kept.back()], polygon[i]))
            kept.push_back(i);
    while (closure == Closure::closed && kept.size() > 1 &&
           std::ranges::equal(polygon[kept.back()], polygon[kept.front()]))
        kept.pop_back();
    return kept;
}

} // namespace

std::vector<int> turn_signs(const PointSet& polygon, Closure closure) {
    const std::vector<Index> kept = distinct(polygon, closure);
    const std::size_t n = kept.size();
    std::vector<int> signs;
    if (n < 3) return signs;
    const std::size_t turns = closure == Closure::closed ? n : n - 2;
    for (std::size_t i = 0; i < turns; ++i) {
        const double t =
            turn(polygon[kept[i % n]], polygon[kept[(i + 1) % n]], polygon[kept[(i + 2) % n]]);
        signs.push_back(t > 0 ? 1 : t < 0 ? -1 : 0);
    }
    return signs;
}

Index inflection_count(const PointSet& polygon, Closure closure) {
    std::vector<int> signs = turn_signs(polygon, closure);
    std::erase(signs, 0);
    Index count = 0;
    for (std::size_t i = 1; i < signs.size(); ++i) count += signs[i] != signs[i - 1] ? 1 : 0;
    if (closure == Closure::closed && signs.size() > 1 && signs.back() != signs.front()) ++count;
    return count;
}

} // namespace batten
