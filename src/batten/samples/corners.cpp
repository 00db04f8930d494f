#include <batten/samples/corners.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Angle between b - a and c - b; 0 when one has no length.
double turning(std::span<const double> a, std::span<const double> b, std::span<const double> c) {
    double aa = 0;
    double bb = 0;
    double ab = 0;
    for (std::size_t d = 0; d < a.size(); ++d) {
        const double u = b[d] - a[d];
        const double v = c[d] - b[d];
        aa += u * u;
        bb += v * v;
        ab += u * v;
    }
    return aa > 0 && bb > 0 ? std::acos(std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0)) : 0;
}

} // namespace

std::vector<Index> find_corners(const Points& p, Closure closure) {
    constexpr double sharp = 0.6; // radians, 34 degrees
    std::vector<Index> corners;
    const Index m = p.size();
    const bool closed = closure == Closure::closed;
    if (m < 5) return corners;
    const auto at = [&](Index i) { return p[(i + m) % m]; };
    const auto turn = [&](Index i, Index reach) {
        return turning(at(i - reach), at(i), at(i + reach));
    };
    for (Index i = closed ? 0 : 2; i + (closed ? 0 : 2) < m; ++i) {
        const double here = turn(i, 1);
        if (here < sharp || turn(i, 2) < sharp) continue;
        const double beside = std::max(turn(i - 1, 1), turn(i + 1, 1));
        if (beside < here / 3) corners.push_back(i);
    }
    return corners;
}

} // namespace batten
