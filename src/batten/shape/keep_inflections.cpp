#include <batten/shape/limits.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace batten {

namespace {

using Point = std::array<double, 2>;

Point operator-(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1]};
}

/// p + part * move.
Point along(const Point& p, const Point& move, double part) {
    return {p[0] + part * move[0], p[1] + part * move[1]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1];
}

/// A line through `from`, or the ray that leaves it.
struct Line {
    Point from;
    Point direction;
};

/// Part of the way from p along the move at which it meets the line, in (0, 1]; none when it does
/// not.
std::optional<double> meeting(const Point& p, const Point& move, const Line& line,
                              Barrier barrier) {
    const auto& [a, d] = line;
    const double across = d[0] * move[1] - d[1] * move[0];
    const double gap = d[0] * (a[1] - p[1]) - d[1] * (a[0] - p[0]);
    if (across == 0) return std::nullopt;
    const double part = gap / across;
    if (!(part > 0 && part <= 1))
        return std::nullopt; // a point on the line already is not held by it
    if (barrier == Barrier::rays && dot(along(p, move, part) - a, d) < 0) return std::nullopt;
    return part;
}

/// A polygon whose points move one after the other.
class MovingPolygon {
  public:
    MovingPolygon(const PointSet& polygon, Closure closure, std::span<const double> centre)
        : points_(polygon), closed_(closure == Closure::closed), kept_(kept_roundings, centre) {}

    std::optional<Point> at(Index i) const {
        const Index n = points_.size();
        if (closed_) i = (i % n + n) % n;
        if (i < 0 || i >= n) return std::nullopt;
        return Point{points_(i, 0), points_(i, 1)};
    }
    void put(Index i, const Point& p) { std::ranges::copy(p, points_[i].begin()); }
    /// Signs of the turns at i and beside it that count.
    std::array<int, 3> turns(Index i) const { return {sign(i - 1), sign(i), sign(i + 1)}; }
    /// Whether the turn at i is none that the roundings of an iteration add up to.
    bool distinct(Index i) const { return sign(i, distinct_roundings) != 0; }
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
    int sign(Index i) const { return sign(i, kept_); }
    /// How many straight turns at i and beside it are crowded.
    int crowds_beside(Index i) const { return crowds(i - 1) + crowds(i) + crowds(i + 1); }

  private:
    int sign(Index i, const TurnMargin& margin) const {
        const auto a = at(i - 1), b = at(i), c = at(i + 1);
        if (!a || !b || !c) return 0;
        return turn_sign(*a, *b, *c, margin);
    }
    int crowds(Index i) const {
        const auto a = at(i - 1), b = at(i), c = at(i + 1);
        return a && b && c && sign(i) == 0 && crowded(*a, *b, *c) ? 1 : 0;
    }
    /// Sign of the first turn from i on that bends.
    int nearest(Index i, Index step) const {
        for (Index count = 0; count < points_.size() && at(i); ++count, i += step)
            if (const int found = sign(i)) return found;
        return 0;
    }

    PointSet points_; ///< those that have moved in their new places
    bool closed_;
    TurnMargin kept_;
};

/// The lines that point i may not cross.
std::vector<Line> barriers(const MovingPolygon& polygon, Index i, Barrier barrier) {
    const auto before = polygon.at(i - 2), last = polygon.at(i - 1);
    const auto next = polygon.at(i + 1), after = polygon.at(i + 2);
    std::vector<Line> lines;
    if (barrier == Barrier::lines) {
        if (last && next) lines.push_back({*last, *next - *last});
        if (last && before) lines.push_back({*last, *before - *last});
        if (next && after) lines.push_back({*next, *after - *next});
        return lines;
    }
    if (!last || !next) return lines; // each situation has four points
    if (before) {                     // situation (a)
        lines.push_back({*last, *next - *last});
        lines.push_back({*last, *before - *last});
    }
    if (after) { // situation (b), whose N is beyond the next point
        lines.push_back({*next, *last - *next});
        lines.push_back({*next, *next - *after});
    }
    return lines;
}

/// Shortens the moves of a polygon's points in order.
class Limiter {
  public:
    Limiter(const PointSet& polygon, Closure closure, const InflectionLimit& limit)
        : moved_(polygon, closure, limit.centre), limit_(limit) {}

    /// Moves point i; returns its move.
    Point operator()(Index i, const Point& move) {
        const Point p = *moved_.at(i);
        const Point shortened = along({}, move, part_of(i, p, move));
        if (limit_.barrier == Barrier::rays || goes(i, p, shortened)) {
            moved_.put(i, along(p, shortened, 1));
            return shortened;
        }
        // a turn is straight, or has all but vanished: what is left is to slide past it
        for (Index turn : {i, i - 1, i + 1})
            if (const auto slid = sliding(i, turn, p, move); slid && goes(i, p, *slid)) {
                moved_.put(i, along(p, *slid, 1));
                return *slid;
            }
        return {};
    }

  private:
    /// The part of a move that the lines allow.
    double part_of(Index i, const Point& p, const Point& move) const {
        double part = 1;
        for (const Line& line : barriers(moved_, i, limit_.barrier))
            if (const auto met = meeting(p, move, line, limit_.barrier))
                part = std::min(part, limit_.alpha * *met);
        return part;
    }

    /// Whether point i may move so: the turns at i and beside it have their signs; those without
    /// one have none and are not crowded, or bend distinctly and not to and fro.
    bool goes(Index i, const Point& p, const Point& move) {
        const std::array<int, 3> before = moved_.turns(i);
        const int bends = moved_.bends(i);
        const int crowds = moved_.crowds_beside(i);
        moved_.put(i, along(p, move, 1));
        const std::array<int, 3> now = moved_.turns(i);
        bool good = true;
        for (std::size_t k = 0; k < now.size(); ++k)
            good = good && (now[k] == before[k] ||
                            (before[k] == 0 && moved_.distinct(i - 1 + static_cast<Index>(k))));
        good = good && (now == before || moved_.bends(i) <= bends) &&
               moved_.crowds_beside(i) <= crowds;
        moved_.put(i, p);
        return good;
    }

    /// The move along the line through the other two points of a turn, on it where they are
    /// straight; not past a neighbour.
    std::optional<Point> sliding(Index i, Index turn, const Point& p, const Point& move) const {
        const auto a = moved_.at(turn == i - 1 ? i - 2 : turn == i ? i - 1 : i + 1);
        const auto b = moved_.at(turn == i - 1 ? i - 1 : turn == i ? i + 1 : i + 2);
        if (!a || !b) return std::nullopt;
        const Point d = *b - *a;
        const double square = dot(d, d);
        if (!(square > 0)) return std::nullopt;
        const Point start = moved_.sign(turn) == 0 ? along(*a, d, dot(p - *a, d) / square) : p;
        double part = dot(move, d) / square;
        for (Index beside : {i - 1, i + 1})
            if (const auto q = moved_.at(beside)) {
                const double there = dot(*q - start, d) / square;
                if (there * part > 0 && std::abs(part) >= std::abs(there))
                    part = limit_.alpha * there;
            }
        const Point slid = along(start, d, part) - p;
        return along({}, slid, part_of(i, p, slid));
    }

    MovingPolygon moved_;
    InflectionLimit limit_;
};

/// Whether the polygon is straight somewhere, and keeps its shape when all its points move at once.
/// Points in one place make no line: their first moves are far from where they are going.
bool bends_as_a_whole(const PointSet& polygon, const PointSet& moves, Closure closure,
                      const TurnMargin& margin) {
    const std::vector<int> signs = turn_signs(polygon, closure, margin);
    const Index turns = closure == Closure::closed ? polygon.size() : polygon.size() - 2;
    if (std::ranges::count(signs, 0) == 0 || static_cast<Index>(signs.size()) < turns) return false;
    PointSet moved = polygon;
    add_scaled(moved, 1, moves);
    return keeps_shape(polygon, moved, closure, margin, distinct_roundings);
}

} // namespace

void keep_inflections(const PointSet& polygon, PointSet& moves, Closure closure,
                      const InflectionLimit& limit) {
    // one by one the points would bend it to and fro
    if (limit.barrier == Barrier::lines &&
        bends_as_a_whole(polygon, moves, closure, {kept_roundings, limit.centre}))
        return;
    Limiter limited(polygon, closure, limit);
    for (Index i = 0; i < polygon.size(); ++i)
        std::ranges::copy(limited(i, {moves(i, 0), moves(i, 1)}), moves[i].begin());
}

} // namespace batten
