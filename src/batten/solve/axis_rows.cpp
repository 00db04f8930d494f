#include <batten/solve/axis_rows.hpp>

#include <batten/system/roughness.hpp>

#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

namespace batten {

AxisRows::AxisRows(KnotVector knots, std::span<const double> parameters,
                   std::span<const double> weights, int order)
    : knots_(std::move(knots)), parameters_(parameters), weights_(weights) {
    total_weight_ = weights.empty() ? static_cast<double>(parameters.size())
                                    : std::accumulate(weights.begin(), weights.end(), 0.0);
    const BandedQr shape = empty(0);
    std::vector<Index> lead;
    std::vector<Index> begin(static_cast<std::size_t>(shape.inner_size() + 2));
    for (double t : parameters) {
        const double inside = knots_.wrapped(t);
        if (!knots_.contains(inside)) throw outside_domain(knots_, fmt::format("parameter {}", t));
        lead.push_back(shape.lead(knots_.span(inside) - knots_.degree()));
        ++begin[static_cast<std::size_t>(lead.back() + 1)];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    order_.resize(parameters.size());
    for (std::size_t i = 0; i < lead.size(); ++i)
        order_[static_cast<std::size_t>(begin[static_cast<std::size_t>(lead[i])]++)] =
            static_cast<Index>(i);
    const double scale = unit_roughness_scale(knots_, order);
    for_each_roughness_row(knots_, order, knots_.degree() - order + 1,
                           [&](double weight, const ActiveFunctions& derivatives) {
                               rough_.push_back({derivatives, scale * weight});
                           });
    std::ranges::stable_sort(
        rough_, {}, [&](const Rough& rough) { return shape.row(rough.derivatives, 1).lead; });
}

BandedQr AxisRows::empty(Index columns) const {
    return {knots_.free_count(), knots_.degree(), knots_.closure(), columns};
}

void AxisRows::add_samples(BandedQr& qr, std::size_t begin, std::size_t end, Values values) const {
    std::vector<Extended> right(static_cast<std::size_t>(qr.rhs_columns()));
    for (std::size_t k = begin; k < end; ++k) {
        const auto at = static_cast<std::size_t>(order_[k]);
        const Extended root = weights_.empty() ? 1 : std::sqrt(Extended(weights_[at]));
        values(order_[k], right.data());
        if (root != 1)
            for (Extended& x : right) x *= root;
        qr.add(qr.row(active_functions(knots_, parameters_[at], Numbering::free), root),
               right.data());
    }
}

BandedQr AxisRows::reduced(Index columns, Values values) const {
    const Index chunk = std::max<Index>(1 << 14, 4 * knots_.free_count()); // each has a triangle
    BandedQr result = empty(columns);
    const auto count = static_cast<Index>(order_.size());
    if (count <= chunk) {
        add_samples(result, 0, order_.size(), values);
        return result;
    }
    std::vector<BandedQr> parts(static_cast<std::size_t>(block_count(count, chunk)), result);
    for_each_block(count, chunk, [&](const Block& block) {
        add_samples(parts[static_cast<std::size_t>(block.index)],
                    static_cast<std::size_t>(block.begin), static_cast<std::size_t>(block.end),
                    values);
    });
    result.merge(parts);
    return result;
}

BandedQr AxisRows::smoothed(const BandedQr& samples, double factor) const {
    BandedQr result = empty(samples.rhs_columns());
    std::vector<Extended> right(static_cast<std::size_t>(samples.rhs_columns()));
    auto next = rough_.begin();
    for (Index i = 0; i < knots_.free_count(); ++i) {
        for (; next != rough_.end() && result.lead(next->derivatives.first) <= i; ++next) {
            std::ranges::fill(right, Extended{0});
            result.add(
                result.row(next->derivatives, std::sqrt(Extended(factor) * Extended(next->weight))),
                right.data());
        }
        std::ranges::copy(samples.rotated(i), right.begin());
        result.add(samples.row(i), right.data());
    }
    return result;
}

} // namespace batten
