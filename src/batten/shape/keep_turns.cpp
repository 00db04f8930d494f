#include <batten/shape/limits.hpp>

namespace batten {

void keep_turns(const PointSet& polygon, PointSet& moves, Closure closure, double threshold) {
    const auto same = [&](double part) {
        PointSet moved = polygon;
        add_scaled(moved, part, moves);
        return keeps_shape(polygon, moved, closure, certain_roundings, certain_roundings);
    };
    if (same(1)) return;
    double good = 0.5;
    while (!same(good) && good > 1e-18) good /= 2;
    if (good <= 1e-18) good = 0;
    // as close as possible to the whole move
    double bad = 1;
    while (good > 0 && bad - good > threshold) {
        const double middle = (good + bad) / 2;
        (same(middle) ? good : bad) = middle;
    }
    for (double& x : moves.values()) x *= good;
}

} // namespace batten
