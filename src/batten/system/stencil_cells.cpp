#include <batten/system/stencil_system.hpp>

#include <batten/system/chebyshev_maps.hpp>
#include <batten/system/moments.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>

namespace batten {

/// What the samples of one cell (span x span) add.
struct StencilSystem::CellSums {
    Index span[2];
    std::vector<double> grams;  ///< pairs of axis 0 (i <= j) x pairs of axis 1
    std::vector<double> rhs;    ///< (p + 1)(q + 1) x dim
    std::vector<double> axis_0; ///< pairs of axis 0 alone
    std::vector<double> axis_1;
    double weight = 0;
    double energy = 0;
};

namespace {

constexpr Index sort_block = 1 << 15;

/// Finds spans in O(1): a table over even steps of the domain gives the span at a step's start, a
/// few comparisons the rest.
class SpanTable {
  public:
    explicit SpanTable(const KnotVector& knots) : knots_(knots) {
        for (Index k = knots.degree(); k < knots.control_count(); ++k)
            if (knots[k + 1] > knots[k]) {
                spans_.push_back(k);
                ends_.push_back(knots[k + 1]);
            }
        const std::size_t steps = 4 * spans_.size();
        scale_ = static_cast<double>(steps) / knots.length();
        std::size_t at = 0;
        for (std::size_t step = 0; step < steps; ++step) {
            while (at + 1 < spans_.size() &&
                   ends_[at] <= knots.begin() + static_cast<double>(step) / scale_)
                ++at;
            first_.push_back(static_cast<std::int32_t>(at));
        }
    }
    /// Position of t's span among the spans with length; t inside the domain.
    std::int32_t operator()(double t) const {
        const auto step =
            std::min(static_cast<std::size_t>((t - knots_.begin()) * scale_), first_.size() - 1);
        auto at = static_cast<std::size_t>(first_[step]);
        while (at > 0 && t < ends_[at - 1]) --at; // rounding of the step
        while (at + 1 < ends_.size() && t >= ends_[at]) ++at;
        return static_cast<std::int32_t>(at);
    }
    const std::vector<Index>& spans() const { return spans_; }

  private:
    const KnotVector& knots_;
    std::vector<Index> spans_;
    std::vector<double> ends_;
    std::vector<std::int32_t> first_;
    double scale_;
};

/// Samples sorted by cell, as planes: s, t, weight, coordinates relative to the centre.
struct SortedSamples {
    std::vector<double> planes;
    std::vector<Index> cell_begin;
    Index count;
    const double* plane(Index k) const { return planes.data() + k * count; }
    double* plane(Index k) { return planes.data() + k * count; }
};

SortedSamples sort_by_cell(const std::vector<KnotVector>& axes, const SpanTable& u,
                           const SpanTable& v, const std::vector<ChebyshevPairs>& maps_u,
                           const std::vector<ChebyshevPairs>& maps_v,
                           const std::vector<double>& centre, const Points& points,
                           const Points& parameters, std::span<const double> weights) {
    const Index m = points.size();
    const auto columns = static_cast<std::int32_t>(v.spans().size());
    const Index dim = points.dim();
    std::vector<std::int32_t> cell(static_cast<std::size_t>(m));
    for_each_block(m, sort_block, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            double t[2];
            for (Index k = 0; k < 2; ++k) {
                const KnotVector& knots = axes[static_cast<std::size_t>(k)];
                t[k] = knots.wrapped(parameters(i, k));
                if (!knots.contains(t[k]))
                    throw outside_domain(knots, fmt::format("axis {}: parameter {}", k, t[k]));
            }
            cell[static_cast<std::size_t>(i)] = u(t[0]) * columns + v(t[1]);
        }
    });
    SortedSamples sorted{std::vector<double>(static_cast<std::size_t>(m * (3 + dim))),
                         std::vector<Index>(u.spans().size() * v.spans().size() + 1), m};
    for (std::int32_t c : cell) ++sorted.cell_begin[static_cast<std::size_t>(c) + 1];
    for (std::size_t c = 1; c < sorted.cell_begin.size(); ++c)
        sorted.cell_begin[c] += sorted.cell_begin[c - 1];
    std::vector<Index> next(sorted.cell_begin.begin(), sorted.cell_begin.end() - 1);
    for (Index i = 0; i < m; ++i) {
        const std::int32_t c = cell[static_cast<std::size_t>(i)];
        const Index at = next[static_cast<std::size_t>(c)]++;
        const ChebyshevPairs& a = maps_u[static_cast<std::size_t>(c / columns)];
        const ChebyshevPairs& b = maps_v[static_cast<std::size_t>(c % columns)];
        sorted.plane(0)[at] = (axes[0].wrapped(parameters(i, 0)) - a.middle()) * a.scale();
        sorted.plane(1)[at] = (axes[1].wrapped(parameters(i, 1)) - b.middle()) * b.scale();
        sorted.plane(2)[at] = weights.empty() ? 1.0 : weights[static_cast<std::size_t>(i)];
        for (Index d = 0; d < dim; ++d)
            sorted.plane(3 + d)[at] = points(i, d) - centre[static_cast<std::size_t>(d)];
    }
    return sorted;
}

std::vector<ChebyshevPairs> maps_of(const KnotVector& knots, const SpanTable& table) {
    std::vector<ChebyshevPairs> maps;
    for (Index span : table.spans()) maps.emplace_back(knots, span);
    return maps;
}

/// One cell's moments turned into what its B-splines need.
template <class Sums>
void convert(const ChebyshevPairs& a, const ChebyshevPairs& b, int p, int q, Index dim,
             const std::vector<Lanes>& moment_lanes, const std::vector<Lanes>& value_lanes,
             Sums& sums) {
    const int rows = 2 * p + 1;
    const int columns = 2 * q + 1;
    const Index pairs_u = (p + 1) * (p + 2) / 2;
    const Index pairs_v = (q + 1) * (q + 2) / 2;
    std::vector<double> moments(static_cast<std::size_t>(rows * columns));
    for (std::size_t k = 0; k < moments.size(); ++k) moments[k] = moment_lanes[k].sum();
    std::vector<double> half(
        static_cast<std::size_t>(rows * pairs_v)); // moments along axis 0, pairs along axis 1
    for (int r = 0; r < rows; ++r)
        for (int k = 0; k <= q; ++k)
            for (int l = k; l <= q; ++l)
                half[static_cast<std::size_t>(r * pairs_v + pair_row(k, l, q))] =
                    b.pair(k, l, moments.data() + r * columns);
    sums.grams.assign(static_cast<std::size_t>(pairs_u * pairs_v), 0.0);
    for (int i = 0; i <= p; ++i)
        for (int j = i; j <= p; ++j) {
            const double* coefficient = a.pair_coefficients(i, j);
            double* out = sums.grams.data() + pair_row(i, j, p) * pairs_v;
            for (int r = 0; r < rows; ++r)
                for (Index k = 0; k < pairs_v; ++k)
                    out[k] += coefficient[r] * half[static_cast<std::size_t>(r * pairs_v + k)];
            sums.axis_0.push_back(a.pair(i, j, moments.data(), columns));
        }
    for (int k = 0; k <= q; ++k)
        for (int l = k; l <= q; ++l) sums.axis_1.push_back(b.pair(k, l, moments.data()));
    sums.rhs.assign(static_cast<std::size_t>((p + 1) * (q + 1) * dim), 0.0);
    for (int r = 0; r <= p; ++r)
        for (int c = 0; c <= q; ++c)
            for (Index d = 0; d < dim; ++d) {
                const double value =
                    value_lanes[static_cast<std::size_t>((r * (q + 1) + c) * dim + d)].sum();
                for (int i = 0; i <= p; ++i)
                    for (int k = 0; k <= q; ++k)
                        sums.rhs[static_cast<std::size_t>((i * (q + 1) + k) * dim + d)] +=
                            a.coefficients(i)[r] * b.coefficients(k)[c] * value;
            }
    sums.weight = moments[0];
}

} // namespace

void StencilSystem::add_cells(const Points& points, const Points& parameters,
                              std::span<const double> weights) {
    const int p = axes_[0].degree();
    const int q = axes_[1].degree();
    const SpanTable u(axes_[0]);
    const SpanTable v(axes_[1]);
    const std::vector<ChebyshevPairs> maps_u = maps_of(axes_[0], u);
    const std::vector<ChebyshevPairs> maps_v = maps_of(axes_[1], v);
    const SortedSamples sorted =
        sort_by_cell(axes_, u, v, maps_u, maps_v, centre_, points, parameters, weights);
    const auto columns = static_cast<Index>(v.spans().size());
    std::vector<std::vector<CellSums>> rows(u.spans().size());
    for_each_chunk(static_cast<Index>(rows.size()), [&](Index row) {
        std::vector<Lanes> moments(static_cast<std::size_t>((2 * p + 1) * (2 * q + 1)));
        std::vector<Lanes> values(static_cast<std::size_t>((p + 1) * (q + 1) * dim()));
        for (Index column = 0; column < columns; ++column) {
            const auto cell = static_cast<std::size_t>(row * columns + column);
            const Index begin = sorted.cell_begin[cell];
            const Index count = sorted.cell_begin[cell + 1] - begin;
            if (count == 0) continue;
            std::fill(moments.begin(), moments.end(), Lanes{});
            std::fill(values.begin(), values.end(), Lanes{});
            add_cell_moments({sorted.plane(0) + begin, sorted.plane(1) + begin,
                              sorted.plane(2) + begin, sorted.plane(3) + begin, sorted.count, count,
                              dim()},
                             p, q, moments.data(), values.data());
            CellSums sums{{u.spans()[static_cast<std::size_t>(row)],
                           v.spans()[static_cast<std::size_t>(column)]},
                          {},
                          {},
                          {},
                          {},
                          0,
                          0};
            convert(maps_u[static_cast<std::size_t>(row)], maps_v[static_cast<std::size_t>(column)],
                    p, q, dim(), moments, values, sums);
            for (Index d = 0; d < dim(); ++d)
                for (Index k = begin; k < begin + count; ++k)
                    sums.energy +=
                        sorted.plane(2)[k] * sorted.plane(3 + d)[k] * sorted.plane(3 + d)[k];
            rows[static_cast<std::size_t>(row)].push_back(std::move(sums));
        }
    });
    for (const auto& row : rows) // in order: the same bits for any number of threads
        for (const CellSums& sums : row) merge(sums);
}

void StencilSystem::merge(const CellSums& sums) {
    const int p = axes_[0].degree();
    const int q = axes_[1].degree();
    const Index pairs_v = (q + 1) * (q + 2) / 2;
    const auto row_of = [&](Index i, std::size_t axis) {
        return (sums.span[axis] - axes_[axis].degree() + i) % controls_.length(axis);
    };
    for (Index i = 0; i <= p; ++i)
        for (Index k = 0; k <= q; ++k) {
            const Index control = controls_.at({row_of(i, 0), row_of(k, 1)});
            for (Index j = i; j <= p; ++j)
                for (Index l = 0; l <= q; ++l) {
                    const Index place = (j - i) * (2 * q + 1) + l - k + q;
                    at(place, control) += sums.grams[static_cast<std::size_t>(
                        pair_row(i, j, p) * pairs_v + pair_row(std::min(k, l), std::max(k, l), q))];
                }
            for (Index d = 0; d < dim(); ++d)
                rhs_(control, d) +=
                    sums.rhs[static_cast<std::size_t>((i * (q + 1) + k) * dim() + d)];
        }
    for (Index i = 0; i <= p; ++i)
        for (Index j = i; j <= p; ++j)
            axis_grams_[0].at(row_of(i, 0), static_cast<int>(j - i)) +=
                sums.axis_0[static_cast<std::size_t>(pair_row(i, j, p))];
    for (Index k = 0; k <= q; ++k)
        for (Index l = k; l <= q; ++l)
            axis_grams_[1].at(row_of(k, 1), static_cast<int>(l - k)) +=
                sums.axis_1[static_cast<std::size_t>(pair_row(k, l, q))];
    total_weight_ += sums.weight;
    data_energy_ += sums.energy;
}

} // namespace batten
