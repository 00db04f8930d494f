#include <batten/basis/place_knots.hpp>
#include <batten/spline/spline.hpp>

#include <algorithm>
#include <fmt/format.h>

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

/// The knots from the domain's begin to its end.
std::span<const double> domain_knots(const KnotVector& knots) {
    return knots.knots().subspan(
        static_cast<std::size_t>(knots.degree()),
        static_cast<std::size_t>(knots.control_count() - knots.degree() + 1));
}

/// Refined control points of one strand of control points along the axis.
PointSet refine_strand(const KnotVector& old, const PointSet& control, const KnotVector& refined) {
    const int p = old.degree();
    const Index n = refined.free_count();
    PointSet result(refined.control_count(), control.dim());
    const Index first =
        refined.closed() ? p : 0; // closed: the windows p to p + n - 1 start in the domain
    for (Index j = first; j < first + n; ++j) {
        const Index span = old.span(refined[j]);
        const auto point = blossom(
            old, control, span,
            refined.knots().subspan(static_cast<std::size_t>(j + 1), static_cast<std::size_t>(p)));
        const Index at = refined.closed() ? j % n : j;
        for (Index k = at; k < result.size(); k += n) std::ranges::copy(point, result[k].begin());
    }
    return result;
}

Spline over_knots(const Spline& spline, Index axis, const KnotVector& refined) {
    const KnotVector& old = spline.axis(axis);
    const auto along = static_cast<std::size_t>(axis);
    const GridIndex grid(spline.control_shape());
    const Index inner = grid.stride(along) * spline.dim();
    const Index values_of_block = old.control_count() * inner;
    std::vector<double> values;
    for (Index k = 0; k < grid.blocks(along); ++k) {
        const double* block = spline.control_points().data() + k * values_of_block;
        const PointSet strand(std::vector<double>(block, block + values_of_block), inner);
        const PointSet fine = refine_strand(old, strand, refined);
        values.insert(values.end(), fine.values().begin(), fine.values().end());
    }
    std::vector<KnotVector> axes = spline.axes();
    axes[along] = refined;
    return {std::move(axes), PointSet(std::move(values), spline.dim())};
}

} // namespace

Spline refine(const Spline& spline, Index axis, const KnotVector& refined) {
    const KnotVector& old = spline.axis(axis);
    if (refined.degree() != old.degree() || refined.closure() != old.closure() ||
        !std::ranges::includes(domain_knots(refined), domain_knots(old)))
        throw InvalidInput(
            fmt::format("axis {}: the refined knots must contain the present ones", axis));
    return over_knots(spline, axis, refined);
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
    for (Index k = 0; k < spline.axis_count(); ++k) {
        const KnotVector& old = spline.axis(k);
        std::vector<double> interior;
        for (double t : old.knots())
            if (t > old.begin() && t < old.end()) interior.push_back(t);
        result =
            over_knots(result, k, knots_around(old.degree(), interior, old.begin(), old.end()));
    }
    return result;
}

} // namespace batten
