#include <batten/basis/place_knots.hpp>
#include <batten/spline/spline.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <iterator>

namespace batten {

std::vector<double> blossom(const KnotVector& knots, const PointSet& control, Index span,
                            std::span<const double> arguments) {
    const int p = knots.degree();
    const auto dim = static_cast<std::size_t>(control.dim());
    std::vector<double> d(static_cast<std::size_t>(p + 1) * dim);
    for (int r = 0; r <= p; ++r)
        std::copy_n(control[span - p + r].data(), dim, d.begin() + r * static_cast<Index>(dim));
    for (int level = 1; level <= p; ++level)
        for (int r = p; r >= level; --r) {
            const Index i = span - p + r;
            const double low = knots[i];
            const double high = knots[i + p - level + 1];
            const double alpha =
                (arguments[static_cast<std::size_t>(level - 1)] - low) / (high - low);
            for (std::size_t k = 0; k < dim; ++k) {
                const std::size_t here = static_cast<std::size_t>(r) * dim + k;
                d[here] = (1 - alpha) * d[here - dim] + alpha * d[here];
            }
        }
    return {d.end() - static_cast<Index>(dim), d.end()};
}

namespace {

/// Knots of one axis and control points, a row of coordinates for each B-spline.
struct Strand {
    std::vector<double> knots;
    PointSet control;
};

/// The strand with ascending knots `fresh`, none outside its domain, among its own: every control
/// point between two old ones, whatever the spans' lengths [PieglTiller1997, algorithm A5.4].
Strand inserted(int degree, const Strand& old, std::span<const double> fresh) {
    const Index p = degree;
    const Index added = static_cast<Index>(fresh.size());
    const Index rows = old.control.size();
    if (added == 0) return old;
    const auto knot = [&](Index i) { return old.knots[static_cast<std::size_t>(i)]; };
    Strand result{std::vector<double>(old.knots.size() + fresh.size()),
                  PointSet(rows + added, old.control.dim())};
    PointSet& q = result.control;
    const auto place = [&](Index at, double value) {
        result.knots[static_cast<std::size_t>(at)] = value;
    };
    const auto first = std::ranges::upper_bound(old.knots, fresh.front()) - old.knots.begin() - 1;
    Index i = rows + p;         // old knots beyond it stand in their places
    Index k = rows + p + added; // and in the result those beyond this one
    const auto keep = [&] {
        if (i > p) std::ranges::copy(old.control[i - p - 1], q[k - p - 1].begin());
        place(k--, knot(i--));
    };
    for (Index j = added; j-- > 0;) {
        const double x = fresh[static_cast<std::size_t>(j)];
        while (i > first && x <= knot(i)) keep();
        std::ranges::copy(q[k - p], q[k - p - 1].begin());
        for (Index l = 1; l <= p; ++l) {
            const double right = result.knots[static_cast<std::size_t>(k + l)];
            const double part = right > x ? (right - x) / (right - knot(i - p + l)) : 0;
            const auto here = q[k - p + l - 1];
            const auto next = q[k - p + l];
            for (std::size_t d = 0; d < here.size(); ++d)
                here[d] = part * here[d] + (1 - part) * next[d];
        }
        place(k--, x);
    }
    while (i >= 0) keep();
    return result;
}

/// What makes another spline's strands of a spline's.
using Change = std::function<Strand(const Strand&)>;

/// The spline with `change` done along one axis, over the axis `changed` then has.
Spline along_axis(const Spline& spline, Index axis, const KnotVector& changed,
                  const Change& change) {
    const KnotVector& old = spline.axis(axis);
    const auto along = static_cast<std::size_t>(axis);
    const GridIndex grid(spline.control_shape());
    const Index inner = grid.stride(along) * spline.dim();
    const Index values_of_block = old.control_count() * inner;
    const std::vector<double> knots(old.knots().begin(), old.knots().end());
    std::vector<double> values;
    for (Index k = 0; k < grid.blocks(along); ++k) {
        const double* block = spline.control_points().data() + k * values_of_block;
        const PointSet control(std::vector<double>(block, block + values_of_block), inner);
        const Strand strand = change({knots, control});
        values.insert(values.end(), strand.control.values().begin(), strand.control.values().end());
    }
    std::vector<KnotVector> axes = spline.axes();
    axes[along] = changed;
    return {std::move(axes), PointSet(std::move(values), spline.dim())};
}

/// Those of `all` that `present` lacks, counted as often as they stand; both ascending.
std::vector<double> missing(std::span<const double> all, std::span<const double> present) {
    std::vector<double> result;
    std::ranges::set_difference(all, present, std::back_inserter(result));
    return result;
}

/// The knots of one period of a closed axis from the domain's begin on, and how they go on.
struct Turn {
    explicit Turn(const KnotVector& axis)
        : count(axis.free_count()),
          period(axis.length()),
          first(std::ranges::lower_bound(axis.knots(), axis.begin()) - axis.knots().begin()) {
        const auto begin = axis.knots().begin() + first;
        knots.assign(begin, begin + count);
    }

    double operator[](Index i) const {
        const Index turn = i >= 0 ? i / count : -((count - 1 - i) / count);
        return knots[static_cast<std::size_t>(i - turn * count)] +
               static_cast<double>(turn) * period;
    }

    Index count;
    double period;
    Index first; ///< where the axis has the first of them
    std::vector<double> knots;
};

Strand refined_turn(const KnotVector& old, const KnotVector& refined, const Strand& strand) {
    const Index p = old.degree();
    const Turn from(old);
    const Turn to(refined);
    Strand open{{}, PointSet(from.count + 2 * p, strand.control.dim())}; // over a turn and p spans
    for (Index i = -p; i <= from.count + 2 * p; ++i) open.knots.push_back(from[i]);
    for (Index i = 0; i < open.control.size(); ++i) {
        const Index at = (i - p + from.first + p * from.count) % from.count;
        std::ranges::copy(strand.control[at], open.control[i].begin());
    }
    const std::vector<double> once = missing(to.knots, from.knots);
    std::vector<double> fresh;
    for (Index turn = 0; turn <= p && !once.empty(); ++turn)
        for (double t : once) {
            const double x = t + static_cast<double>(turn) * from.period;
            if (x <= from[from.count + p]) fresh.push_back(x);
        }
    const Strand fine = inserted(old.degree(), open, fresh);
    Strand result{{}, PointSet(refined.control_count(), strand.control.dim())};
    for (Index i = 0; i < result.control.size(); ++i) {
        const Index at = p + (i - to.first + p * to.count) % to.count;
        std::ranges::copy(fine.control[at], result.control[i].begin());
    }
    return result;
}

/// The strand over the same domain, with end knots of full multiplicity.
Strand clamped_strand(const KnotVector& axis, const Strand& strand) {
    const auto p = static_cast<std::size_t>(axis.degree());
    const auto more = [&](double end) {
        const auto present = static_cast<std::size_t>(std::ranges::count(axis.knots(), end));
        return p - std::min(p, present);
    };
    std::vector<double> fresh(more(axis.begin()), axis.begin());
    fresh.insert(fresh.end(), more(axis.end()), axis.end());
    const Strand whole = inserted(axis.degree(), strand, fresh);
    const auto at = whole.knots.begin();
    const Index first =
        std::ranges::upper_bound(whole.knots, axis.begin()) - at - 1 - axis.degree();
    const Index last = std::ranges::lower_bound(whole.knots, axis.end()) - at - 1;
    Strand result{{}, PointSet(last + 1 - first, strand.control.dim())};
    for (Index i = first; i <= last; ++i)
        std::ranges::copy(whole.control[i], result.control[i - first].begin());
    return result;
}

bool is_clamped(const KnotVector& axis) {
    return !axis.closed() && axis[0] == axis.begin() &&
           axis[axis.control_count() + axis.degree()] == axis.end();
}

Spline clamped_along(const Spline& spline, Index axis) {
    const KnotVector& old = spline.axis(axis);
    if (is_clamped(old)) return spline;
    std::vector<double> interior;
    for (double t : old.knots())
        if (t > old.begin() && t < old.end()) interior.push_back(t);
    return along_axis(spline, axis, knots_around(old.degree(), interior, old.begin(), old.end()),
                      [&](const Strand& strand) { return clamped_strand(old, strand); });
}

/// Whether an open axis has another's knots, none of the others outside the domain.
bool extends(const KnotVector& refined, const KnotVector& old) {
    return std::ranges::includes(refined.knots(), old.knots()) &&
           std::ranges::all_of(missing(refined.knots(), old.knots()),
                               [&](double t) { return old.contains(t); });
}

} // namespace

Spline refine(const Spline& spline, Index axis, const KnotVector& refined) {
    const KnotVector& old = spline.axis(axis);
    const bool alike = refined.degree() == old.degree() && refined.closure() == old.closure() &&
                       refined.begin() == old.begin() && refined.end() == old.end();
    if (alike && old.closed() && std::ranges::includes(Turn(refined).knots, Turn(old).knots))
        return along_axis(spline, axis, refined,
                          [&](const Strand& strand) { return refined_turn(old, refined, strand); });
    if (alike && !old.closed() && extends(refined, old))
        return along_axis(spline, axis, refined, [&](const Strand& strand) {
            return inserted(old.degree(), strand, missing(refined.knots(), old.knots()));
        });
    if (alike && !old.closed() && !is_clamped(old))
        return refine(clamped_along(spline, axis), axis, refined);
    throw InvalidInput(
        fmt::format("axis {}: the refined knots must contain the present ones", axis));
}

Spline insert_knot(const Spline& spline, Index axis, double t, int times) {
    const KnotVector& old = spline.axis(axis);
    if (!(t >= old.begin() && t <= old.end()))
        throw InvalidInput(fmt::format("axis {}: knot {} is outside the domain [{}, {}]", axis, t,
                                       old.begin(), old.end()));
    const auto present = std::ranges::count(old.knots(), t);
    const bool at_end = !old.closed() && (t == old.begin() || t == old.end());
    if (at_end || present + times > old.degree())
        throw InvalidInput(
            fmt::format("axis {}: knot {} would have a multiplicity above the degree {}", axis, t,
                        old.degree()));
    const auto first = old.knots().begin() + (old.closed() ? old.degree() + 1 : 0);
    const auto last = old.closed() ? old.knots().begin() + old.control_count() : old.knots().end();
    std::vector<double> knots(first, last);
    if (old.closed() && t == old.end()) t = old.begin();
    knots.insert(std::ranges::upper_bound(knots, t), static_cast<std::size_t>(times), t);
    if (old.closed())
        return refine(spline, axis,
                      knots_around(old.degree(), knots, old.begin(), old.end(), Closure::closed));
    return refine(spline, axis, {old.degree(), std::move(knots), Closure::open});
}

Spline clamped(const Spline& spline) {
    Spline result = spline;
    for (Index k = 0; k < spline.axis_count(); ++k) result = clamped_along(result, k);
    return result;
}

} // namespace batten
