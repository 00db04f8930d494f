#include <batten/system/stencil_system.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/system/roughness.hpp>

#include <algorithm>
#include <cstdlib>
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
    for (const KnotVector& axis : axes_)
        axis_grams_.emplace_back(axis.free_count(), axis.degree(), axis.closure());
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
    sample_count_ += points.size();
    if (axes_.size() == 2) return add_cells(points, parameters, weights);
    for (Index i = 0; i < points.size(); ++i)
        add_sample(points[i], parameters[i].data(),
                   weights.empty() ? 1.0 : weights[static_cast<std::size_t>(i)]);
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
        for (const Local& b : local) {
            const Index step = b.place[0] - a.place[0];
            if (step < 0) continue;
            const Index place =
                (step * (2 * second + 1) + b.place[1] - a.place[1] + second) * (2 * third + 1) +
                b.place[2] - a.place[2] + third;
            at(place, a.control) += weight * a.value * b.value;
        }
        for (Index d = 0; d < dim(); ++d)
            rhs_(a.control, d) +=
                weight * a.value *
                (point[static_cast<std::size_t>(d)] - centre_[static_cast<std::size_t>(d)]);
    }
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        const KnotVector& knots = axes_[k];
        const double t = knots.wrapped(parameter[k]);
        const Index span = knots.span(t);
        const BasisValues b = basis_values(knots, span, t);
        for (int i = 0; i <= knots.degree(); ++i)
            for (int j = i; j <= knots.degree(); ++j)
                axis_grams_[k].at((span - knots.degree() + i) % knots.free_count(), j - i) +=
                    weight * b[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(j)];
    }
    total_weight_ += weight;
    for (std::size_t d = 0; d < point.size(); ++d)
        data_energy_ += weight * (point[d] - centre_[d]) * (point[d] - centre_[d]);
}

namespace {

BATTEN_VECTOR_CLONES
void add_products(double* y, const double* s, const double* x, Index count) {
    for (Index i = 0; i < count; ++i) y[i] += s[i] * x[i];
}

} // namespace

void StencilSystem::apply_plane(const double* x, double* y) const {
    constexpr Index block = 2048;
    const Index n = size();
    std::fill(y, y + n, 0.0);
    for (Index begin = 0; begin < n; begin += block)
        for (Index place = 0; place < width_; ++place) {
            const Index offset = flat_offsets_[static_cast<std::size_t>(place)];
            const Index first =
                std::max(begin, -offset); // entries that would leave the net are zero
            const Index last = std::min({begin + block, n, n - offset});
            if (first >= last) continue;
            const double* s = stencil_.data() + place * n + first;
            add_products(y + first, s, x + first + offset, last - first);
            if (place >= same_slice_) add_products(y + first + offset, s, x + first, last - first);
        }
}

void StencilSystem::apply(const PointSet& x, PointSet& y) const {
    if (any_closed_) {
        y.fill(0);
        for_each_entry([&](Index i, Index j, double value) {
            for (Index d = 0; d < x.dim(); ++d) y(i, d) += value * x(j, d);
        });
        return;
    }
    const Index n = size();
    if (x.dim() == 1) return apply_plane(x.data(), y.data());
    std::vector<double> planes(static_cast<std::size_t>(2 * n * x.dim()));
    for_each_chunk(x.dim(), [&](Index d) {
        double* in = planes.data() + 2 * d * n;
        double* out = in + n;
        for (Index i = 0; i < n; ++i) in[i] = x(i, d);
        apply_plane(in, out);
        for (Index i = 0; i < n; ++i) y(i, d) = out[i];
    });
}

std::vector<double> StencilSystem::diagonal() const {
    std::vector<double> result(static_cast<std::size_t>(size()));
    for_each_entry([&](Index i, Index j, double value) {
        if (i == j) result[static_cast<std::size_t>(i)] += value;
    });
    return result;
}

void StencilSystem::add_roughness(double lambda, int order) {
    const double weight = total_weight_ > 0 ? total_weight_ : 1;
    for (std::size_t rough = 0; rough < axes_.size(); ++rough) {
        std::vector<BandedMatrix> matrices;
        for (std::size_t k = 0; k < axes_.size(); ++k)
            matrices.push_back(roughness_matrix(axes_[k], k == rough ? order : 0));
        add_product(lambda * weight, matrices);
        axis_grams_[rough].add(lambda * weight, matrices[rough]);
    }
}

void StencilSystem::add_product(double factor, const std::vector<BandedMatrix>& matrices) {
    for (Index place = 0; place < width_; ++place)
        for (Index i = 0; i < size(); ++i) {
            double value = factor;
            Index rest = i;
            for (std::size_t k = shape_.size(); k-- > 0 && value != 0;) {
                const Index n = shape_[k];
                const Index row = rest % n;
                rest /= n;
                const Index step = offsets_[static_cast<std::size_t>(place)][k];
                Index from = step >= 0 ? row : row + step;
                if (axes_[k].closed()) from = (from + n) % n;
                const bool outside = !axes_[k].closed() && (from < 0 || row + step >= n);
                value *= outside ? 0 : matrices[k].at(from, static_cast<int>(std::abs(step)));
            }
            at(place, i) += value;
        }
}

} // namespace batten
