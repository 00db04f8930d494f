#include <batten/solve/sample_rows.hpp>

#include <algorithm>
#include <numeric>

namespace batten {

namespace {

PointSet rounded(const std::vector<Extended>& values, Index dim) {
    return {std::vector<double>(values.begin(), values.end()), dim};
}

} // namespace

RowFactorization::RowFactorization(const std::vector<KnotVector>& axes, const SampleRows& rows,
                                   const std::vector<double>& centre)
    : controls_(free_shape(axes)), dim_(rows.samples.dim()) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
        rows_.emplace_back(axes[k], rows.parameters.axes[k],
                           axes.size() == 1 ? rows.samples.weights : std::span<const double>(),
                           rows.order);
        reduce(k, rows.lambda * rows_[k].total_weight(), rows, centre);
    }
}

void RowFactorization::reduce(std::size_t axis, double factor, const SampleRows& rows,
                              const std::vector<double>& centre) {
    const std::vector<Index> shape = rows.samples.shape();
    Index inner = dim_;
    for (std::size_t k = axis + 1; k < shape.size(); ++k) inner *= shape[k];
    Index outer = 1;
    for (std::size_t k = 0; k < axis; ++k) outer *= controls_.length(k);
    const Index n = controls_.length(axis);
    const std::vector<Extended> before = std::move(rotated_);
    rotated_.assign(static_cast<std::size_t>(outer * n * inner), 0);
    std::vector<Extended> left(static_cast<std::size_t>(outer));
    const auto samples_into = [&](Index i, Extended* values) {
        const double* from = rows.samples.points.data() + i * inner;
        for (Index d = 0; d < inner; ++d)
            values[d] = Extended(from[d]) - Extended(centre[static_cast<std::size_t>(d % dim_)]);
    };
    const auto reduced = [&](Index o) {
        const Extended* block = before.data() + o * shape[axis] * inner;
        const auto block_into = [&](Index i, Extended* values) {
            std::copy_n(block + i * inner, inner, values);
        };
        const BandedQr qr = axis == 0 ? rows_[axis].reduced(inner, samples_into)
                                      : rows_[axis].reduced(inner, block_into);
        return factor > 0 ? rows_[axis].smoothed(qr, factor) : qr;
    };
    std::vector<BandedQr> first; // R is the same for all
    for_each_chunk(outer, [&](Index o) {
        BandedQr qr = reduced(o);
        std::ranges::copy(qr.rotated(), rotated_.begin() + o * n * inner);
        left[static_cast<std::size_t>(o)] = qr.left_over();
        if (o == 0) first.push_back(std::move(qr));
    });
    left_over_ = std::accumulate(left.begin(), left.end(), left_over_);
    axes_.push_back(std::move(first.front()));
}

PointSet RowFactorization::solution() const {
    std::vector<Extended> x = rotated_;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        axes_[k].check();
        axes_[k].solve(x.data(), along(controls_, k, dim_));
    }
    return rounded(x, dim_);
}

PointSet RowFactorization::solve(PointSet b) const {
    std::vector<Extended> x(b.values().begin(), b.values().end());
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        axes_[k].solve_transposed(x.data(), along(controls_, k, b.dim()));
        axes_[k].solve(x.data(), along(controls_, k, b.dim()));
    }
    return rounded(x, b.dim());
}

std::unique_ptr<BandedSaddle> RowFactorization::bordered(const Constraints& constraints) const {
    if (axes_.size() != 1) return nullptr;
    return std::make_unique<BandedSaddle>(
        axes_[0].size(), axes_[0].closure(),
        [&](BandedSaddle::Visit visit) { axes_[0].for_each_product(visit); }, constraints);
}

} // namespace batten
