#include <batten/spline/spline.hpp>

#include <batten/core/counts.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

std::vector<Index> stored_shape(std::span<const KnotVector> axes) {
    std::vector<Index> shape;
    for (const KnotVector& k : axes) shape.push_back(k.control_count());
    return shape;
}

/// Copies the block of `to` shape out of `from`, wrapping each index into the source.
PointSet copy_wrapped(const PointSet& source, const std::vector<Index>& from,
                      const std::vector<Index>& to) {
    PointSet result(checked_product(to, "spline"), source.dim());
    std::vector<Index> at(to.size(), 0);
    for (Index row = 0; row < result.size(); ++row) {
        Index k = 0;
        for (std::size_t a = 0; a < to.size(); ++a) k = k * from[a] + at[a] % from[a];
        for (Index d = 0; d < source.dim(); ++d) result(row, d) = source(k, d);
        for (std::size_t a = to.size(); a-- > 0;) {
            if (++at[a] < to[a]) break;
            at[a] = 0;
        }
    }
    return result;
}

} // namespace

std::vector<Index> free_shape(std::span<const KnotVector> axes) {
    std::vector<Index> shape;
    for (const KnotVector& k : axes) shape.push_back(k.free_count());
    return shape;
}

Spline::Spline(std::vector<KnotVector> axes, PointSet control)
    : axes_(std::move(axes)), control_(std::move(control)) {
    if (axes_.empty() || axes_.size() > 3)
        throw InvalidInput(fmt::format("spline: {} axes given, 1 to 3 are possible", axes_.size()));
    if (checked_product(control_shape(), "spline") != control_.size())
        throw InvalidInput(fmt::format("spline: {} control points given, the knots need {}",
                                       control_.size(), fmt::join(control_shape(), "x")));
}

Spline Spline::from_free(std::vector<KnotVector> axes, const PointSet& free_control) {
    const std::vector<Index> from = free_shape(axes);
    if (checked_product(from, "spline") != free_control.size())
        throw InvalidInput(fmt::format("spline: {} free control points given, the knots need {}",
                                       free_control.size(), fmt::join(from, "x")));
    PointSet control = copy_wrapped(free_control, from, stored_shape(axes));
    return {std::move(axes), std::move(control)};
}

std::vector<Index> Spline::control_shape() const {
    return stored_shape(axes_);
}

PointSet Spline::free_control_points() const {
    return copy_wrapped(control_, control_shape(), free_shape(axes_));
}

} // namespace batten
