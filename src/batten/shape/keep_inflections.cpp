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

} // namespace

void keep_inflections(const PointSet& polygon, PointSet& moves, Closure closure, double alpha,
                      Barrier barrier) {
    constexpr double kept_roundings = 16; // the turns stay certain after a shift of coordinates
    const Index n = polygon.size();
    PointSet moved = polygon; // points before i hold their new places
    const auto at = [&](Index i) -> std::optional<Point> {
        if (closure == Closure::closed) i = (i % n + n) % n;
        if (i < 0 || i >= n) return std::nullopt;
        return Point{moved(i, 0), moved(i, 1)};
    };
    const auto sign = [&](Index i) { // of the turn at i
        const auto a = at(i - 1), b = at(i), c = at(i + 1);
        if (!a || !b || !c) return 0;
        return turn_sign(*a, *b, *c, kept_roundings);
    };
    const auto turns = [&](Index i) { return std::array{sign(i - 1), sign(i), sign(i + 1)}; };
    for (Index i = 0; i < n; ++i) {
        const Point p{polygon(i, 0), polygon(i, 1)};
        const Point move{moves(i, 0), moves(i, 1)};
        double part = 1;
        const auto hold = [&](std::optional<Point> a, std::optional<Point> b) {
            if (!a || !b) return;
            if (const auto met = meeting(p, move, *a, *b, barrier))
                part = std::min(part, alpha * *met);
        };
        hold(at(i - 1), at(i + 1));
        hold(at(i - 1), at(i - 2));
        hold(at(i + 1), at(i + 2));
        // rays leave from either neighbour
        if (barrier == Barrier::rays) hold(at(i + 1), at(i - 1));
        const auto before = turns(i);
        for (Index d = 0; d < 2; ++d) {
            moves(i, d) *= part;
            moved(i, d) = polygon(i, d) + moves(i, d);
        }
        if (barrier == Barrier::lines &&
            turns(i) != before) // rounding, where a turn has all but vanished
            for (Index d = 0; d < 2; ++d) {
                moves(i, d) = 0;
                moved(i, d) = polygon(i, d);
            }
    }
}

} // namespace batten
