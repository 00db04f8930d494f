#include <batten/shape/limits.hpp>

#include <batten/core/vectors.hpp>

namespace batten {

void keep_turns(const PointSet& polygon, PointSet& moves, Closure closure, double threshold,
                KeptTurns* kept) {
    constexpr double shortest = 1e-18;
    const auto lost = [&](double part) {
        PointSet moved = polygon;
        add_scaled(moved, part, moves);
        return lost_turn(polygon, moved, closure, certain_roundings, certain_roundings);
    };
    double good = 1;
    double bad = 1;
    std::optional<Index> held_by = lost(good);
    if (held_by) good = 0.5;
    while (held_by && good > shortest) {
        const std::optional<Index> here = lost(good);
        if (!here) break;
        held_by = here;
        good /= 2;
    }
    if (good <= shortest) good = 0;
    // as close as possible to the whole move
    while (good > 0 && bad - good > threshold) {
        const double middle = (good + bad) / 2;
        const std::optional<Index> here = lost(middle);
        if (here) held_by = here;
        (here ? bad : good) = middle;
    }
    scale(moves.values(), good);
    if (kept != nullptr) *kept = {kept->sum + good, good, kept->steps + 1, held_by};
}

} // namespace batten
