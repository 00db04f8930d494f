#include <batten/shape/limits.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace batten {

namespace {

using Point = std::array<double, 2>;

/// Part of the way from p along the move at which it meets the line a b, in (0, 1]; none when it
/// does not. `ray`: only the side of a on which b lies counts.
std::optional<double> meeting(const Point& p, const Point& move, const Point& a, const Point& b,
                              Barrier barrier) {
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const double across = dx * move[1] - dy * move[0];
    const double gap = dx * (a[1] - p[1]) - dy * (a[0] - p[0]);
    if (across == 0) return std::nullopt;
    const double part = gap / across;
    if (!(part > 0 && part <= 1))
        return std::nullopt; // a point on the line already is not held by it
    if (barrier == Barrier::rays) {
        const double x = p[0] + part * move[0] - a[0];
        const double y = p[1] + part * move[1] - a[1];
        if (x * dx + y * dy < 0) return std::nullopt;
    }
    return part;
}

/// A polygon whose points move one after the other.
class MovingPolygon {
  public:
    MovingPolygon(const PointSet& polygon, Closure closure)
        : points_(polygon), closed_(closure == Closure::closed) {}

    std::optional<Point> at(Index i) const {
        const Index n = points_.size();
        if (closed_) i = (i % n + n) % n;
        if (i < 0 || i >= n) return std::nullopt;
        return Point{points_(i, 0), points_(i, 1)};
    }
    void put(Index i, const Point& p) { std::ranges::copy(p, points_[i].begin()); }
    /// Signs of the turns at i and beside it that are more than so many roundings.
    std::array<int, 3> turns(Index i, double roundings = kept_roundings) const {
        return {sign(i - 1, roundings), sign(i, roundings), sign(i + 1, roundings)};
    }
    /// How often the turns change sign from the next one before these to the next one after them.
    int bends(Index i) const {
        int count = 0;
        int last = nearest(i - 2, -1);
        for (int now : {sign(i - 1), sign(i), sign(i + 1), nearest(i + 2, 1)}) {
            if (now == 0) continue;
            count += last != 0 && now != last ? 1 : 0;
            last = now;
        }
        return count;
    }

  private:
    int sign(Index i, double roundings = kept_roundings) const {
        const auto a = at(i - 1), b = at(i), c = at(i + 1);
        if (!a || !b || !c) return 0;
        return turn_sign(*a, *b, *c, roundings);
    }
    /// Sign of the first turn from i on that bends.
    int nearest(Index i, Index step) const {
        for (Index count = 0; count < points_.size() && at(i); ++count, i += step)
            if (const int found = sign(i)) return found;
        return 0;
    }

    PointSet points_; ///< those that have moved in their new places
    bool closed_;
};

/// Whether the polygon is straight somewhere, and keeps its shape when all its points move at once.
/// Points in one place make no line: their first moves are far from where they are going.
bool bends_as_a_whole(const PointSet& polygon, const PointSet& moves, Closure closure) {
    const std::vector<int> signs = turn_signs(polygon, closure, kept_roundings);
    const Index turns = closure == Closure::closed ? polygon.size() : polygon.size() - 2;
    if (std::ranges::count(signs, 0) == 0 || static_cast<Index>(signs.size()) < turns) return false;
    PointSet moved = polygon;
    add_scaled(moved, 1, moves);
    return keeps_shape(polygon, moved, closure, kept_roundings, distinct_roundings);
}

/// Whether the turns at i and beside it still are what they were: those with a sign have it; those
/// without one have none, or bend distinctly.
bool kept(const MovingPolygon& moved, Index i, const std::array<int, 3>& before) {
    const std::array<int, 3> now = moved.turns(i);
    const std::array<int, 3> bent = moved.turns(i, distinct_roundings);
    for (std::size_t k = 0; k < now.size(); ++k)
        if (now[k] != before[k] && (before[k] != 0 || bent[k] == 0)) return false;
    return true;
}

} // namespace

void keep_inflections(const PointSet& polygon, PointSet& moves, Closure closure, double alpha,
                      Barrier barrier) {
    // one by one the points would bend it to and fro
    if (barrier == Barrier::lines && bends_as_a_whole(polygon, moves, closure)) return;
    MovingPolygon moved(polygon, closure);
    for (Index i = 0; i < polygon.size(); ++i) {
        const Point p{polygon(i, 0), polygon(i, 1)};
        const Point move{moves(i, 0), moves(i, 1)};
        double part = 1;
        const auto hold = [&](std::optional<Point> a, std::optional<Point> b) {
            if (!a || !b) return;
            if (const auto met = meeting(p, move, *a, *b, barrier))
                part = std::min(part, alpha * *met);
        };
        hold(moved.at(i - 1), moved.at(i + 1));
        hold(moved.at(i - 1), moved.at(i - 2));
        hold(moved.at(i + 1), moved.at(i + 2));
        // rays leave from either neighbour
        if (barrier == Barrier::rays) hold(moved.at(i + 1), moved.at(i - 1));
        const auto turns = moved.turns(i);
        for (Index d = 0; d < 2; ++d) moves(i, d) *= part;
        const Point goal{p[0] + moves(i, 0), p[1] + moves(i, 1)};
        moved.put(i, goal);
        if (barrier == Barrier::rays || moved.turns(i) == turns) continue;
        // what is straight may begin to bend, but not to and fro; else a turn has all but vanished,
        // and it is rounding
        const bool only_bends = kept(moved, i, turns);
        const int bends = moved.bends(i);
        moved.put(i, p);
        if (only_bends && bends <= moved.bends(i))
            moved.put(i, goal);
        else
            for (Index d = 0; d < 2; ++d) moves(i, d) = 0;
    }
}

} // namespace batten
