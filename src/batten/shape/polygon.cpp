#include <batten/shape/polygon.hpp>

#include <batten/core/vectors.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

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

/// Calls `visit(a, b, c)` for the turns at b between distinct points that follow each other;
/// closed: round the seam.
template <class Visit>
void for_each_turn(const PointSet& polygon, Closure closure, Visit visit) {
    const std::vector<Index> kept = distinct(polygon, closure);
    const std::size_t n = kept.size();
    if (n < 3) return;
    const std::size_t turns = closure == Closure::closed ? n : n - 2;
    for (std::size_t i = 0; i < turns; ++i)
        visit(polygon[kept[i]], polygon[kept[(i + 1) % n]], polygon[kept[(i + 2) % n]]);
}

/// A sum of doubles without rounding: parts that do not overlap, in ascending size
/// [Shewchuk1997, theorem 10].
class ExactSum {
  public:
    void add(double x) {
        std::size_t left = 0;
        for (std::size_t k = 0; k < count_; ++k) {
            const double part = parts_[k];
            const double sum = x + part;
            const double of_part = sum - x;
            const double lost = (x - (sum - of_part)) + (part - of_part);
            if (lost != 0) parts_[left++] = lost;
            x = sum;
        }
        if (x != 0) parts_[left++] = x;
        count_ = left;
    }
    void add_product(double x, double y) {
        const double product = x * y;
        add(std::fma(x, y, -product));
        add(product);
    }
    int sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] > 0 ? 1 : -1; }

  private:
    std::array<double, 12> parts_{}; ///< of six products
    std::size_t count_ = 0;
};

/// Sign of the turn at b as the doubles stand, for products within the range of doubles.
int exact_turn_sign(std::span<const double> a, std::span<const double> b,
                    std::span<const double> c) {
    ExactSum sum;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        sum.add_product(p[0], q[1]);
        sum.add_product(-p[1], q[0]);
    }
    return sum.sign();
}

} // namespace

int turn_sign(std::span<const double> a, std::span<const double> b, std::span<const double> c,
              const TurnMargin& margin) {
    if (margin.roundings == exactly) return exact_turn_sign(a, b, c);
    const double t = turn(a, b, c);
    double largest = 0;
    double lengths = 0;
    for (std::size_t d = 0; d < 2; ++d) {
        const double shift = margin.centre.empty() ? 0 : margin.centre[d];
        for (const auto& p : {a, b, c}) largest = std::max(largest, std::abs(p[d] + shift));
        lengths += std::abs(b[d] - a[d]) + std::abs(c[d] - b[d]);
    }
    const double rounding = std::numeric_limits<double>::epsilon() * largest * lengths;
    if (std::abs(t) <= margin.roundings * rounding) return 0;
    return t > 0 ? 1 : -1;
}

bool crowded(std::span<const double> a, std::span<const double> b, std::span<const double> c) {
    constexpr double least = 1e-3;
    const auto [shorter, longer] = std::minmax({distance(a, b), distance(b, c)});
    return shorter <= least * longer || dot(difference(b, a), difference(c, b)) < 0;
}

std::vector<int> turn_signs(const PointSet& polygon, Closure closure, const TurnMargin& margin) {
    std::vector<int> signs;
    for_each_turn(polygon, closure,
                  [&](auto a, auto b, auto c) { signs.push_back(turn_sign(a, b, c, margin)); });
    return signs;
}

Index inflection_count(const PointSet& polygon, Closure closure, const TurnMargin& margin) {
    std::vector<int> signs = turn_signs(polygon, closure, margin);
    std::erase(signs, 0);
    Index count = 0;
    for (std::size_t i = 1; i < signs.size(); ++i) count += signs[i] != signs[i - 1] ? 1 : 0;
    if (closure == Closure::closed && signs.size() > 1 && signs.back() != signs.front()) ++count;
    return count;
}

double total_turning(const PointSet& polygon, Closure closure) {
    double sum = 0;
    for_each_turn(polygon, closure, [&](auto a, auto b, auto c) {
        sum += std::abs(std::atan2(turn(a, b, c), dot(difference(b, a), difference(c, b))));
    });
    return sum;
}

std::optional<Index> lost_turn(const PointSet& polygon, const PointSet& moved, Closure closure,
                               const TurnMargin& margin, double bend) {
    const Index n = polygon.size();
    const auto sign = [&](const PointSet& of, Index i, const TurnMargin& certain) {
        return turn_sign(of[i], of[(i + 1) % n], of[(i + 2) % n], certain);
    };
    std::optional<Index> bent; // what was straight
    for (Index i = 0; i < (closure == Closure::closed ? n : n - 2); ++i) {
        const auto crowds = [&](const PointSet& of) {
            return crowded(of[i], of[(i + 1) % n], of[(i + 2) % n]);
        };
        const int before = sign(polygon, i, margin);
        const int now = sign(moved, i, margin);
        if (now != before && (before != 0 || sign(moved, i, bend) == 0)) return (i + 1) % n;
        if (now == 0 && crowds(moved) && !crowds(polygon)) return (i + 1) % n;
        if (now != before && !bent) bent = (i + 1) % n;
    }
    if (inflection_count(moved, closure, margin) <= inflection_count(polygon, closure, margin))
        return {};
    return bent.value_or(0);
}

bool keeps_shape(const PointSet& polygon, const PointSet& moved, Closure closure,
                 const TurnMargin& margin, double bend) {
    return !lost_turn(polygon, moved, closure, margin, bend);
}

} // namespace batten
