#include <batten/core/vectors.hpp>
#include <batten/shape/limits.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// Points of a polygon from one place where it bends, or ends, to the next.
struct Run {
    std::size_t first;
    std::size_t last;
    int sign; ///< of the turns between these
};

/// The straight runs between turns, indices beyond the last turn's go on round a closed polygon.
/// `signs` are of the points 1, 2, ...; without any sign the polygon turns to the left.
std::vector<Run> straight_runs(const std::vector<int>& signs, std::size_t points, bool closed) {
    const std::size_t turns = signs.size();
    const auto sign = [&](std::size_t i) { return signs[(i + points - 1) % points]; };
    std::vector<Run> runs;
    const auto bent = std::ranges::find_if(signs, [](int s) { return s != 0; });
    if (bent == signs.end()) {
        if (!closed) runs.push_back({0, points - 1, 1});
        return runs;
    }
    const std::size_t begin = closed ? static_cast<std::size_t>(bent - signs.begin()) + 1 : 0;
    const std::size_t end = closed ? begin + points : turns + 1;
    int last = closed ? *bent : 0;
    for (std::size_t from = begin, i = begin + 1; i <= end; ++i) {
        const int now = i == end && !closed ? 0 : sign(i);
        if (now == 0 && i != end) continue;
        if (i > from + 1) runs.push_back({from, i, last != 0 ? last : now});
        from = i;
        last = now;
    }
    return runs;
}

/// Puts the points inside a run on a parabola over its chord, `height` high, where they follow each
/// other along it.
void bow(PointSet& points, const Run& run, double height) {
    const auto at = [&](std::size_t i) { return points[static_cast<Index>(i) % points.size()]; };
    const std::vector<double> a(at(run.first).begin(), at(run.first).end());
    const std::vector<double> d = difference(at(run.last), a);
    const double square = dot(d, d);
    std::vector<double> along{0};
    for (std::size_t i = run.first + 1; i <= run.last; ++i) {
        along.push_back(i < run.last ? dot(difference(at(i), a), d) / square : 1);
        if (!(along.back() > along[along.size() - 2])) return;
    }
    for (std::size_t k = 1; k + 1 < along.size(); ++k) {
        const double u = along[k];
        // to the right of the chord for turns to the left
        const double off = run.sign * height * 4 * u * (1 - u) / std::sqrt(square);
        at(run.first + k)[0] = a[0] + u * d[0] + off * d[1];
        at(run.first + k)[1] = a[1] + u * d[1] - off * d[0];
    }
}

/// A polygon without points that are the one before but for rounding, and where each of all points
/// is in it.
struct Distinct {
    PointSet points;
    std::vector<Index> places{};
};

Distinct distinct(const PointSet& polygon, bool closed, double rounding) {
    constexpr double one = 64; // roundings
    std::vector<double> values;
    Distinct result;
    const auto apart = [&](Index i, Index j) {
        return distance(polygon[i], polygon[j]) > one * rounding;
    };
    Index last = 0;
    for (Index i = 0; i < polygon.size(); ++i) {
        if (i == 0 || apart(last, i)) {
            values.insert(values.end(), polygon[i].begin(), polygon[i].end());
            last = i;
        }
        result.places.push_back(static_cast<Index>(values.size()) / 2 - 1);
    }
    const auto count = static_cast<Index>(values.size()) / 2;
    if (closed && count > 1 && !apart(last, 0)) { // the last are the first
        values.resize(values.size() - 2);
        std::ranges::replace(result.places, count - 1, Index{0});
    }
    result.points = PointSet(std::move(values), 2);
    return result;
}

} // namespace

PointSet with_exact_turns(const PointSet& polygon, Closure closure, Index most) {
    if (inflection_count(polygon, closure, exactly) <= most) return polygon;
    double largest = 0;
    for (double x : polygon.values()) largest = std::max(largest, std::abs(x));
    const bool closed = closure == Closure::closed;
    const double rounding = std::numeric_limits<double>::epsilon() * largest;
    const auto [points, places] = distinct(polygon, closed, rounding);
    const auto n = static_cast<std::size_t>(points.size());
    if (n < 3) return polygon;
    for (double straight : {kept_roundings, 1e2, 1e4}) {
        if (inflection_count(points, closure, straight) > most) continue;
        const std::vector<Run> runs =
            straight_runs(turn_signs(points, closure, straight), n, closed);
        for (double roundings = 1; roundings <= 1 << 20; roundings *= 2) {
            PointSet bent = points;
            for (const Run& run : runs) bow(bent, run, roundings * rounding);
            if (inflection_count(bent, closure, exactly) > most) continue;
            PointSet result = polygon;
            for (Index i = 0; i < polygon.size(); ++i)
                std::ranges::copy(bent[places[static_cast<std::size_t>(i)]], result[i].begin());
            return result;
        }
    }
    return polygon;
}

} // namespace batten
