#include <batten/spline/section.hpp>

#include <batten/basis/active_functions.hpp>
#include <batten/core/vectors.hpp>

namespace batten {

Spline section(const Spline& spline, Index axis, double t) {
    if (spline.axis_count() < 2) throw InvalidInput("section: a curve has no other axis");
    const auto along = static_cast<std::size_t>(axis);
    const ActiveFunctions active = active_functions(spline.axis(axis), t, Numbering::stored);
    const GridIndex grid(spline.control_shape());
    const Index dim = spline.dim();
    PointSet control(grid.size() / grid.length(along), dim);
    Index row = 0;
    grid.for_each_strand(along, [&](const GridIndex::Strand& strand) {
        for (int r = 0; r <= active.degree; ++r)
            add_scaled(control[row].data(), active.value[static_cast<std::size_t>(r)],
                       spline.control_points()[strand[active.index(r)]].data(), dim);
        ++row;
    });
    std::vector<KnotVector> axes = spline.axes();
    axes.erase(axes.begin() + axis);
    return {std::move(axes), std::move(control)};
}

} // namespace batten
