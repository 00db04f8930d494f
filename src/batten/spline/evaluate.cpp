#include <batten/basis/active_functions.hpp>
#include <batten/core/vectors.hpp>
#include <batten/spline/spline.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr Index block_size = 4096;

int order_of(std::span<const int> orders, std::size_t axis) {
    return orders.empty() ? 0 : orders[axis];
}

void check_orders(const Spline& spline, std::span<const int> orders) {
    if (!orders.empty() && static_cast<Index>(orders.size()) != spline.axis_count())
        throw InvalidInput(fmt::format("evaluate: {} derivative orders given for {} axes",
                                       orders.size(), spline.axis_count()));
    for (int k : orders)
        if (k < 0) throw InvalidInput(fmt::format("evaluate: derivative order {} is negative", k));
}

void check_finite(std::span<const double> parameter) {
    for (double t : parameter)
        if (!std::isfinite(t))
            throw InvalidInput(fmt::format("evaluate: parameter {} is not a finite number", t));
}

/// Adds the row of A at a parameter times the control points to `out`.
void add_point(const ActiveRow& row, const PointSet& control, double* out) {
    const Index dim = control.dim();
    row.for_each_active(
        [&](Index i, double value) { add_scaled(out, value, control.data() + i * dim, dim); });
}

} // namespace

std::vector<double> Spline::operator()(std::span<const double> parameter,
                                       std::span<const int> orders) const {
    check_orders(*this, orders);
    if (static_cast<Index>(parameter.size()) != axis_count())
        throw InvalidInput(fmt::format("evaluate: {} parameters given for {} axes",
                                       parameter.size(), axis_count()));
    check_finite(parameter);
    std::vector<double> point(static_cast<std::size_t>(dim()));
    add_point({axes_, parameter, Numbering::stored, orders}, control_, point.data());
    return point;
}

PointSet evaluate(const Spline& spline, const Points& parameters, std::span<const int> orders) {
    check_orders(spline, orders);
    if (parameters.dim() != spline.axis_count())
        throw InvalidInput(fmt::format("evaluate: {} parameters per point given for {} axes",
                                       parameters.dim(), spline.axis_count()));
    PointSet result(parameters.size(), spline.dim());
    for_each_block(parameters.size(), block_size, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            check_finite(parameters[i]);
            add_point({spline.axes(), parameters[i], Numbering::stored, orders},
                      spline.control_points(), result[i].data());
        }
    });
    return result;
}

PointSet evaluate_grid(const Spline& spline, const std::vector<std::vector<double>>& axes,
                       std::span<const int> orders) {
    check_orders(spline, orders);
    if (static_cast<Index>(axes.size()) != spline.axis_count())
        throw InvalidInput(fmt::format("evaluate: parameters of {} axes given for {}", axes.size(),
                                       spline.axis_count()));
    // one axis after the other, last first: control values (outer x n x inner) become (outer x m x
    // inner)
    std::vector<double> values = spline.control_points().values();
    Index inner = spline.dim();
    for (std::size_t a = axes.size(); a-- > 0;) {
        const KnotVector& knots = spline.axes()[a];
        const Index n = knots.control_count();
        const auto m = static_cast<Index>(axes[a].size());
        const Index outer = static_cast<Index>(values.size()) / (n * inner);
        std::vector<double> next(static_cast<std::size_t>(outer * m * inner));
        check_finite(axes[a]);
        std::vector<ActiveFunctions> active;
        for (double t : axes[a])
            active.push_back(active_functions(knots, t, Numbering::stored, order_of(orders, a)));
        const Index rows = std::max<Index>(1, block_size / inner);
        for_each_block(outer * m, rows, [&](const Block& block) {
            for (Index row = block.begin; row < block.end; ++row) {
                const ActiveFunctions& here = active[static_cast<std::size_t>(row % m)];
                for (int r = 0; r <= here.degree; ++r)
                    add_scaled(next.data() + row * inner, here.value[static_cast<std::size_t>(r)],
                               values.data() + (row / m * n + here.index(r)) * inner, inner);
            }
        });
        values = std::move(next);
        inner *= m;
    }
    return {std::move(values), spline.dim()};
}

} // namespace batten
