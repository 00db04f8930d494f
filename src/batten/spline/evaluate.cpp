#include <batten/spline/spline.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr Index chunk_size = 4096;

/// The B-splines that matter at one parameter of one axis.
struct Local {
    Index first;
    BasisValues value;
};

Local local_basis(const KnotVector& knots, double t, int order) {
    if (!std::isfinite(t))
        throw InvalidInput(fmt::format("evaluate: parameter {} is not a finite number", t));
    t = knots.wrapped(t);
    const Index span = knots.span(t);
    return {span - knots.degree(),
            order == 0 ? basis_values(knots, span, t) : basis_derivatives(knots, span, t, order)};
}

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

/// Adds sum over axes' B-splines, from `axis` on, of weight * control point.
void accumulate(const Spline& spline, std::span<const Local> basis, std::size_t axis, Index row,
                double weight, double* out) {
    const KnotVector& knots = spline.axis(static_cast<Index>(axis));
    const Local& local = basis[axis];
    for (int r = 0; r <= knots.degree(); ++r) {
        const Index at = row * knots.control_count() + local.first + r;
        const double w = weight * local.value[static_cast<std::size_t>(r)];
        if (axis + 1 < basis.size()) {
            accumulate(spline, basis, axis + 1, at, w, out);
        } else {
            const auto control = spline.control_points()[at];
            for (std::size_t d = 0; d < control.size(); ++d) out[d] += w * control[d];
        }
    }
}

} // namespace

std::vector<double> Spline::operator()(std::span<const double> parameter,
                                       std::span<const int> orders) const {
    check_orders(*this, orders);
    if (static_cast<Index>(parameter.size()) != axis_count())
        throw InvalidInput(fmt::format("evaluate: {} parameters given for {} axes",
                                       parameter.size(), axis_count()));
    std::array<Local, 3> basis{};
    for (std::size_t a = 0; a < axes_.size(); ++a)
        basis[a] = local_basis(axes_[a], parameter[a], order_of(orders, a));
    std::vector<double> point(static_cast<std::size_t>(dim()));
    accumulate(*this, std::span(basis.data(), axes_.size()), 0, 0, 1.0, point.data());
    return point;
}

PointSet evaluate(const Spline& spline, const Points& parameters, std::span<const int> orders) {
    check_orders(spline, orders);
    if (parameters.dim() != spline.axis_count())
        throw InvalidInput(fmt::format("evaluate: {} parameters per point given for {} axes",
                                       parameters.dim(), spline.axis_count()));
    const auto axes = static_cast<std::size_t>(spline.axis_count());
    PointSet result(parameters.size(), spline.dim());
    for_each_chunk((parameters.size() + chunk_size - 1) / chunk_size, [&](Index chunk) {
        std::array<Local, 3> basis{};
        const Index end = std::min(parameters.size(), (chunk + 1) * chunk_size);
        for (Index i = chunk * chunk_size; i < end; ++i) {
            for (std::size_t a = 0; a < axes; ++a)
                basis[a] = local_basis(spline.axes()[a], parameters(i, static_cast<Index>(a)),
                                       order_of(orders, a));
            accumulate(spline, std::span(basis.data(), axes), 0, 0, 1.0, result[i].data());
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
        std::vector<Local> basis;
        for (double t : axes[a]) basis.push_back(local_basis(knots, t, order_of(orders, a)));
        const Index rows = std::max<Index>(1, chunk_size / inner);
        for_each_chunk((outer * m + rows - 1) / rows, [&](Index chunk) {
            for (Index row = chunk * rows; row < std::min(outer * m, (chunk + 1) * rows); ++row) {
                const Local& local = basis[static_cast<std::size_t>(row % m)];
                double* out = next.data() + row * inner;
                for (int r = 0; r <= knots.degree(); ++r) {
                    const double w = local.value[static_cast<std::size_t>(r)];
                    const double* in = values.data() + (row / m * n + local.first + r) * inner;
                    for (Index k = 0; k < inner; ++k) out[k] += w * in[k];
                }
            }
        });
        values = std::move(next);
        inner *= m;
    }
    return {std::move(values), spline.dim()};
}

} // namespace batten
