#include <batten/system/stencil_system.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

StencilSystem::StencilSystem(std::vector<KnotVector> axes, std::vector<double> centre)
    : NormalSystem(std::move(axes), std::move(centre)), shape_(free_shape(axes_)) {
    std::array<Index, 3> reach{};
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        reach[k] = axes_[k].degree();
        width_ *= k == 0 ? reach[k] + 1 : 2 * reach[k] + 1;
    }
    same_slice_ = width_ / (reach[0] + 1);
    for (Index a = 0; a <= reach[0]; ++a)
        for (Index b = -reach[1]; b <= reach[1]; ++b)
            for (Index c = -reach[2]; c <= reach[2]; ++c) offsets_.push_back({a, b, c});
    for (const auto& [a, b, c] : offsets_) {
        Index flat = a;
        if (axes_.size() > 1) flat = flat * shape_[1] + b;
        if (axes_.size() > 2) flat = flat * shape_[2] + c;
        flat_offsets_.push_back(flat);
    }
    for (const KnotVector& axis : axes_) any_closed_ = any_closed_ || axis.closed();
    stencil_.resize(static_cast<std::size_t>(size() * width_));
}

Index StencilSystem::neighbour(Index control, Index place) const {
    Index result = 0;
    Index stride = 1;
    for (std::size_t k = shape_.size(); k-- > 0;) {
        const Index n = shape_[k];
        Index at = control % n + offsets_[static_cast<std::size_t>(place)][k];
        if (at >= n) at -= n; // only on closed axes does an entry that is not zero go around
        if (at < 0) at += n;
        result += at * stride;
        stride *= n;
        control /= n;
    }
    return result;
}

void StencilSystem::add(const Points& points, const Points& parameters,
                        std::span<const double> weights) {
    for (Index i = 0; i < points.size(); ++i)
        add_sample(points[i], parameters[i].data(),
                   weights.empty() ? 1.0 : weights[static_cast<std::size_t>(i)]);
    sample_count_ += points.size();
}

namespace {

/// The tensor product B-splines that do not vanish at a sample: local places along the axes, row
/// and value.
struct Local {
    std::array<Index, 3> place;
    Index control;
    double value;
};

void local_basis(const std::vector<KnotVector>& axes, const double* parameter,
                 std::vector<Local>& out) {
    out.assign(1, {{0, 0, 0}, 0, 1.0});
    std::vector<Local> next;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const KnotVector& knots = axes[k];
        const double t = knots.wrapped(parameter[k]);
        if (!(t >= knots.begin() && t <= knots.end()))
            throw InvalidInput(
                fmt::format("axis {}: parameter {} is outside the knots' domain [{}, {}]", k, t,
                            knots.begin(), knots.end()));
        const Index span = knots.span(t);
        const BasisValues value = basis_values(knots, span, t);
        next.clear();
        for (const Local& local : out)
            for (Index r = 0; r <= knots.degree(); ++r) {
                const Index at = (span - knots.degree() + r) % knots.free_count();
                Local grown = local;
                grown.place[k] = r;
                grown.control = local.control * knots.free_count() + at;
                grown.value = local.value * value[static_cast<std::size_t>(r)];
                next.push_back(grown);
            }
        out.swap(next);
    }
}

} // namespace

void StencilSystem::add_sample(std::span<const double> point, const double* parameter,
                               double weight) {
    thread_local std::vector<Local> local;
    local_basis(axes_, parameter, local);
    const Index second = axes_.size() > 1 ? axes_[1].degree() : 0;
    const Index third = axes_.size() > 2 ? axes_[2].degree() : 0;
    for (const Local& a : local) {
        double* row = stencil_.data() + a.control * width_;
        for (const Local& b : local) {
            const Index step = b.place[0] - a.place[0];
            if (step < 0) continue;
            const Index place =
                (step * (2 * second + 1) + b.place[1] - a.place[1] + second) * (2 * third + 1) +
                b.place[2] - a.place[2] + third;
            row[place] += weight * a.value * b.value;
        }
        for (Index d = 0; d < dim(); ++d)
            rhs_(a.control, d) +=
                weight * a.value *
                (point[static_cast<std::size_t>(d)] - centre_[static_cast<std::size_t>(d)]);
    }
    for (std::size_t d = 0; d < point.size(); ++d)
        data_energy_ += weight * (point[d] - centre_[d]) * (point[d] - centre_[d]);
}

void StencilSystem::apply(const PointSet& x, PointSet& y) const {
    y.fill(0);
    for_each_entry([&](Index i, Index j, double value) {
        for (Index d = 0; d < x.dim(); ++d) y(i, d) += value * x(j, d);
    });
}

std::vector<double> StencilSystem::diagonal() const {
    std::vector<double> result(static_cast<std::size_t>(size()));
    for_each_entry([&](Index i, Index j, double value) {
        if (i == j) result[static_cast<std::size_t>(i)] += value;
    });
    return result;
}

} // namespace batten
