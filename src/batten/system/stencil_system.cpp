#include <batten/system/stencil_system.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/system/half_stencil.hpp>
#include <batten/system/roughness.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace batten {

namespace {

/// Per axis the others' part in a product of factors, which is that of its own matrix there.
std::vector<BandedMatrix> axis_sums_of(const std::vector<BandedMatrix>& factors) {
    std::vector<BandedMatrix> result;
    for (std::size_t k = 0; k < factors.size(); ++k) {
        double others = 1;
        for (std::size_t l = 0; l < factors.size(); ++l)
            if (l != k) others *= factors[l].total();
        result.emplace_back(factors[k].size(), factors[k].bandwidth(), factors[k].closure());
        result.back().add(others, factors[k]);
    }
    return result;
}

/// Of the factors of a grid, each a sum over the parameters of its axis, the means.
std::vector<BandedMatrix> means_of(std::vector<BandedMatrix> factors) {
    for (BandedMatrix& factor : factors) factor.divide(std::round(factor.total()));
    return factors;
}

} // namespace

StencilSystem::StencilSystem(std::vector<KnotVector> axes, std::vector<double> centre)
    : NormalSystem(std::move(axes), std::move(centre)),
      places_(half_stencil(axes_)),
      same_slice_(places_.stride(0)) {
    places_.for_each([&](GridIndex::Place offset, Index) {
        offset = half_stencil_offset(axes_, offset);
        offsets_.push_back(offset);
        flat_offsets_.push_back(controls_.at(offset));
    });
    std::vector<Index> active;
    for (const KnotVector& axis : axes_) {
        any_closed_ = any_closed_ || axis.closed();
        active.push_back(axis.degree() + 1);
        axis_grams_.emplace_back(axis.free_count(), axis.degree(), axis.closure());
    }
    GridIndex(active).for_each(
        [&](const GridIndex::Place& place, Index) { active_places_.push_back(places_.at(place)); });
    stencil_.resize(static_cast<std::size_t>(GridIndex{places_.size(), size()}.size()));
}

StencilSystem::StencilSystem(SystemSums sums) : StencilSystem(sums.axes, sums.centre) {
    sample_count_ = sums.samples;
    data_energy_ = sums.energy;
    total_weight_ = sums.weight;
    rhs_ = std::move(sums.rhs);
    if (sums.factors.empty()) {
        stencil_ = std::move(sums.stencil);
        axis_grams_ = std::move(sums.axis_sums);
        grid_means_ = std::move(sums.grid_means);
        return;
    }
    add_product(1, sums.factors);
    axis_grams_ = axis_sums_of(sums.factors);
    if (axes_.size() > 1) grid_means_ = means_of(std::move(sums.factors));
}

SystemSums StencilSystem::sums() const {
    SystemSums result = common_sums();
    result.weight = total_weight_;
    result.stencil = stencil_;
    result.axis_sums = axis_grams_;
    result.grid_means = grid_means_;
    return result;
}

Index StencilSystem::neighbour(Index control, Index place) const {
    GridIndex::Place at = controls_.place(control);
    for (std::size_t k = 0; k < controls_.axis_count(); ++k) {
        const Index n = controls_.length(k);
        at[k] += offsets_[static_cast<std::size_t>(place)][k];
        if (at[k] >= n) at[k] -= n; // only on closed axes does an entry that is not zero go around
        if (at[k] < 0) at[k] += n;
    }
    return controls_.at(at);
}

void StencilSystem::add(const Points& points, const Points& parameters,
                        std::span<const double> weights) {
    sample_count_ += points.size();
    if (axes_.size() == 2) return add_cells(points, parameters, weights);
    for (Index i = 0; i < points.size(); ++i)
        add_sample(points[i], parameters[i].data(),
                   weights.empty() ? 1.0 : weights[static_cast<std::size_t>(i)]);
}

void StencilSystem::add_sample(std::span<const double> point, const double* parameter,
                               double weight) {
    for (std::size_t k = 0; k < axes_.size(); ++k)
        if (const double t = axes_[k].wrapped(parameter[k]); !axes_[k].contains(t))
            throw outside_domain(axes_[k], fmt::format("axis {}: parameter {}", k, t));
    const ActiveRow row(axes_, {parameter, axes_.size()}, Numbering::free);
    struct Active {
        Index control;
        double value;
    };
    constexpr std::size_t most_active = (max_degree + 1) * (max_degree + 1) * (max_degree + 1);
    std::array<Active, most_active> active; // set as far as `count`
    std::size_t count = 0;
    row.for_each_active([&](Index control, double value) { active[count++] = {control, value}; });
    const std::size_t one_row = count / static_cast<std::size_t>(axes_[0].degree() + 1);
    const Index middle = same_slice_ / 2; // the place of the offset zero
    for (std::size_t a = 0; a < count; ++a) {
        const auto [control, value] = active[a];
        // the half of the stencil: functions before a's along axis 0 have no place
        for (std::size_t b = a / one_row * one_row; b < count; ++b)
            at(active_places_[b] - active_places_[a] + middle, control) +=
                weight * value * active[b].value;
        for (Index d = 0; d < dim(); ++d)
            rhs_(control, d) +=
                weight * value *
                (point[static_cast<std::size_t>(d)] - centre_[static_cast<std::size_t>(d)]);
    }
    for (std::size_t k = 0; k < axes_.size(); ++k) axis_grams_[k].add_outer(weight, row.axes()[k]);
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
        for (Index place = 0; place < places_.size(); ++place) {
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
        visit_entries([&](Index i, Index j, double value) {
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
    visit_entries([&](Index i, Index j, double value) {
        if (i == j) result[static_cast<std::size_t>(i)] += value;
    });
    return result;
}

void StencilSystem::for_each_entry(EntryVisitor visit) const {
    visit_entries(visit);
}

std::vector<BandedMatrix> StencilSystem::nearby_factors() const {
    std::vector<BandedMatrix> result = axis_grams_;
    for (std::size_t k = 1; k < result.size(); ++k) result[k].divide(total_weight_);
    return result;
}

void StencilSystem::set_grid(const Parameters& grid) {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        grid_means_.emplace_back(axes_[k].free_count(), axes_[k].degree(), axes_[k].closure());
        for (double t : grid.axes[k])
            grid_means_[k].add_outer(1, active_functions(axes_[k], t, Numbering::free));
        grid_means_[k].divide(static_cast<double>(grid.axes[k].size()));
    }
}

void StencilSystem::add_roughness(double lambda, int order) {
    const double weight = total_weight_ > 0 ? total_weight_ : 1;
    std::vector<BandedMatrix> rough;
    for (const KnotVector& axis : axes_) rough.push_back(unit_roughness_matrix(axis, order));
    // the axes that a term is rough along: of a grid any, of a cloud one
    for (unsigned along = 1; along < 1U << axes_.size(); ++along) {
        if (grid_means_.empty() && std::popcount(along) > 1) continue;
        double factor = weight;
        std::vector<BandedMatrix> matrices;
        for (std::size_t k = 0; k < axes_.size(); ++k) {
            const bool is_rough = (along >> k & 1U) != 0;
            if (is_rough) factor *= lambda;
            matrices.push_back(is_rough              ? rough[k]
                               : grid_means_.empty() ? unit_roughness_matrix(axes_[k], 0)
                                                     : grid_means_[k]);
        }
        add_product(factor, matrices);
    }
    for (std::size_t k = 0; k < axes_.size(); ++k) axis_grams_[k].add(lambda * weight, rough[k]);
}

void StencilSystem::add_product(double factor, const std::vector<BandedMatrix>& matrices) {
    for (Index place = 0; place < places_.size(); ++place)
        for (Index i = 0; i < size(); ++i) {
            const GridIndex::Place at_control = controls_.place(i);
            double value = factor;
            bool outside = false; // of the net, where there is no entry, whatever the factor
            for (std::size_t k = axes_.size(); k-- > 0 && !outside;) {
                const Index n = controls_.length(k);
                const Index row = at_control[k];
                const Index step = offsets_[static_cast<std::size_t>(place)][k];
                Index from = step >= 0 ? row : row + step;
                if (axes_[k].closed()) from = (from + n) % n;
                outside = !axes_[k].closed() && (from < 0 || row + step >= n);
                if (!outside) value *= matrices[k].at(from, static_cast<int>(std::abs(step)));
            }
            if (!outside) at(place, i) += value;
        }
}

} // namespace batten
