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
        if (!knots_.contains(knots_.wrapped(t)))
            throw outside_domain(knots_, fmt::format("parameter {}", t));
        lead.push_back(shape.row(active_functions(knots_, t, Numbering::free), 1).lead);
        ++begin[static_cast<std::size_t>(lead.back() + 1)];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    order_.resize(parameters.size());
    for (std::size_t i = 0; i < lead.size(); ++i)
        order_[static_cast<std::size_t>(begin[static_cast<std::size_t>(lead[i])]++)] =
            static_cast<Index>(i);
    for_each_roughness_row(knots_, order, knots_.degree() - order + 1,
                           [&](double weight, const ActiveFunctions& derivatives) {
                               rough_.push_back({derivatives, weight});
                           });
    std::ranges::stable_sort(
        rough_, {}, [&](const Rough& rough) { return shape.row(rough.derivatives, 1).lead; });
}

BandedQr AxisRows::empty(Index columns) const {
    return {knots_.free_count(), knots_.degree(), knots_.closure(), columns};
}

BandedQr AxisRows::reduced(double factor, Index columns, Values values) const {
    BandedQr result = empty(columns);
    std::vector<Extended> right(static_cast<std::size_t>(columns));
    std::size_t next = 0;
    const auto add_rough_up_to = [&](Index lead) {
        for (; factor > 0 && next < rough_.size(); ++next) {
            const Extended root = std::sqrt(Extended(factor) * Extended(rough_[next].weight));
            const BandedRow row = result.row(rough_[next].derivatives, root);
            if (row.lead > lead) return;
            std::ranges::fill(right, Extended{0});
            result.add(row, right.data());
        }
    };
    for (Index i : order_) {
        const auto at = static_cast<std::size_t>(i);
        const Extended root = weights_.empty() ? 1 : std::sqrt(Extended(weights_[at]));
        const BandedRow row =
            result.row(active_functions(knots_, parameters_[at], Numbering::free), root);
        add_rough_up_to(row.lead);
        values(i, right.data());
        for (Extended& x : right) x *= root;
        result.add(row, right.data());
    }
    add_rough_up_to(knots_.free_count());
    return result;
}

BandedQr AxisRows::smoothed(const BandedQr& samples, double factor) const {
    BandedQr result = empty(0);
    std::size_t next = 0;
    for (Index i = 0; i < knots_.free_count(); ++i) {
        for (; next < rough_.size(); ++next) {
            const Extended root = std::sqrt(Extended(factor) * Extended(rough_[next].weight));
            const BandedRow row = result.row(rough_[next].derivatives, root);
            if (row.lead > i) break;
            result.add(row, nullptr);
        }
        result.add(samples.row(i), nullptr);
    }
    return result;
}

} // namespace batten
