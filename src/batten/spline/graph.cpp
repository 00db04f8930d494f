#include <batten/spline/graph.hpp>

namespace batten {

Spline graph(const Spline& function) {
    const Index axes = function.axis_count();
    std::vector<KnotVector> open;
    std::vector<std::vector<double>> places;
    for (const KnotVector& axis : function.axes()) {
        open.emplace_back(axis.degree(),
                          std::vector<double>(axis.knots().begin(), axis.knots().end()));
        places.push_back(greville_abscissae(axis));
    }
    PointSet control(function.control_points().size(), axes + 1);
    GridIndex(function.control_shape()).for_each([&](const GridIndex::Place& place, Index i) {
        for (Index k = 0; k < axes; ++k) {
            const auto a = static_cast<std::size_t>(k);
            control(i, k) = places[a][static_cast<std::size_t>(place[a])];
        }
        control(i, axes) = function.control_points()(i, 0);
    });
    return {std::move(open), std::move(control)};
}

} // namespace batten
