#pragma once

#include <batten/shape/polygon.hpp>

#include <vector>

namespace batten {

/// D of keep_turns where none is stated.
inline constexpr double default_turn_threshold = 1e-3;

/// What Algorithm 1 of [LinWangDong2004] has done so far.
struct KeptTurns {
    double sum = 0;  ///< of the factors epsilon_k
    double last = 1; ///< epsilon_k
    Index steps = 0;
    std::optional<Index> held_by{}; ///< the point at whose turn the last moves were shortened
};

/// Shortens all moves by one factor epsilon_k until the moved polygon, convex or not, turns the
/// same way everywhere as the present one: Algorithm 1 of [LinWangDong2004], whose line 3 means L'
/// where it prints L. `threshold` is its D as a part of the longest move. Where the polygon is
/// straight it may begin to bend, unless it gets inflections by that. The factors' sum may stay
/// finite, which their Theorem 2 excludes silently: the iteration can lock.
void keep_turns(const PointSet& polygon, PointSet& moves, Closure closure = Closure::open,
                double threshold = default_turn_threshold, KeptTurns* kept = nullptr);

/// What a control point may not cross.
enum class Barrier {
    lines, ///< the whole lines through its neighbours, the first and the last point's too
    rays,  ///< what [ChangMaDeng2023, section 4.4] prints, (a) and (b), and nothing else
};

/// How moves are shortened one by one.
struct InflectionLimit {
    double alpha = 0.8; ///< the part of the way to a line that is allowed, in (0, 1)
    Barrier barrier = Barrier::lines;
    std::vector<double> centre{}; ///< what the polygon is relative to (2); empty: to nothing
};

/// Shortens the moves one by one, in order, so that no control point crosses a line through its
/// neighbours, and so no turn of the polygon changes sign [ChangMaDeng2023, section 4.4], nor does
/// when `centre` is added. Where the polygon is straight it may stay so, and its points slide along
/// it, or begin to bend, unless it gets inflections by that; where a turn has all but vanished they
/// slide, too. With rays as printed nothing of this is looked at, and turns do change sign: of a
/// point that crosses a line where no ray is, and of the first and the last one, for which no
/// situation has four points.
void keep_inflections(const PointSet& polygon, PointSet& moves, Closure closure = Closure::open,
                      const InflectionLimit& limit = {});

/// The polygon as close as rounding allows with at most `most` inflections in the doubles as they
/// stand: turns that are none but for rounding make an arc, by as many roundings as its being seen
/// takes. As it is where it has no more, or nothing helps.
PointSet with_exact_turns(const PointSet& polygon, Closure closure, Index most);

} // namespace batten
