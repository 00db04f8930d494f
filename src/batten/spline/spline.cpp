#include <batten/spline/spline.hpp>

#include <algorithm>
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
PointSet copy_wrapped(const PointSet& source, const GridIndex& from, const GridIndex& to) {
    PointSet result(to.size(), source.dim());
    to.for_each([&](GridIndex::Place place, Index row) {
        for (std::size_t k = 0; k < from.axis_count(); ++k) place[k] %= from.length(k);
        std::ranges::copy(source[from.at(place)], result[row].begin());
    });
    return result;
}

} // namespace

std::vector<Index> free_shape(std::span<const KnotVector> axes) {
    std::vector<Index> shape;
    for (const KnotVector& k : axes) shape.push_back(k.free_count());
    return shape;
}

std::string_view kind_name(const Spline& spline) {
    constexpr std::string_view names[] = {"curve", "surface", "volume"};
    return names[spline.axis_count() - 1];
}

Spline::Spline(std::vector<KnotVector> axes, PointSet control)
    : axes_(std::move(axes)), control_(std::move(control)) {
    if (axes_.empty() || axes_.size() > 3)
        throw InvalidInput(fmt::format("spline: {} axes given, 1 to 3 are possible", axes_.size()));
    if (GridIndex(control_shape()).size() != control_.size())
        throw InvalidInput(fmt::format("spline: {} control points given, the knots need {}",
                                       control_.size(), fmt::join(control_shape(), "x")));
}

Spline Spline::from_free(std::vector<KnotVector> axes, const PointSet& free_control) {
    const GridIndex from(free_shape(axes));
    if (from.size() != free_control.size())
        throw InvalidInput(fmt::format("spline: {} free control points given, the knots need {}",
                                       free_control.size(), fmt::join(from.shape(), "x")));
    PointSet control = copy_wrapped(free_control, from, GridIndex(stored_shape(axes)));
    return {std::move(axes), std::move(control)};
}

std::vector<Index> Spline::control_shape() const {
    return stored_shape(axes_);
}

PointSet Spline::free_control_points() const {
    return copy_wrapped(control_, GridIndex(control_shape()), GridIndex(free_shape(axes_)));
}

} // namespace batten
