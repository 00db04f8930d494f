#include <batten/system/factored_system.hpp>

#include <algorithm>
#include <cassert>

namespace batten {

namespace {

void add_gram_row(BandedMatrix& gram, const Collocation& a, Index j, double weight) {
    for (int r = 0; r <= a.degree(); ++r)
        for (int s = r; s <= a.degree(); ++s)
            gram.at(a.column(j, r), s - r) += weight * a.value(j, r) * a.value(j, s);
}

} // namespace

FactoredSystem::FactoredSystem(std::vector<KnotVector> axes, std::vector<double> centre,
                               const Parameters& parameters)
    : NormalSystem(std::move(axes), std::move(centre)), slice_values_(dim()) {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        collocations_.emplace_back(axes_[k], parameters.axes[k]);
        grams_.emplace_back(axes_[k].free_count(), axes_[k].degree(), axes_[k].closure());
        if (axes_.size() > 1)
            for (Index j = 0; j < collocations_[k].rows(); ++j)
                add_gram_row(grams_[k], collocations_[k], j, 1.0);
        if (k > 0) slice_values_ *= collocations_[k].rows();
    }
    slices_sum_.resize(static_cast<std::size_t>(axes_[0].free_count() * slice_values_));
}

void FactoredSystem::add(Index first, const Points& slices, std::span<const double> weights) {
    assert(weights.empty() || axes_.size() == 1);
    const Collocation& a = collocations_[0];
    const Index count = slices.size() * dim() / slice_values_;
    std::vector<double> shifted(static_cast<std::size_t>(slice_values_));
    for (Index j = 0; j < count; ++j) {
        const double* slice = slices.data() + j * slice_values_;
        const double weight = weights.empty() ? 1.0 : weights[static_cast<std::size_t>(j)];
        for (Index k = 0; k < slice_values_; ++k) {
            const double x = slice[k] - centre_[static_cast<std::size_t>(k % dim())];
            shifted[static_cast<std::size_t>(k)] = x;
            data_energy_ += weight * x * x;
        }
        if (axes_.size() == 1) add_gram_row(grams_[0], a, first + j, weight);
        for (int r = 0; r <= a.degree(); ++r) {
            const double w = weight * a.value(first + j, r);
            double* to = slices_sum_.data() + a.column(first + j, r) * slice_values_;
            for (Index k = 0; k < slice_values_; ++k)
                to[k] += w * shifted[static_cast<std::size_t>(k)];
        }
    }
    sample_count_ += slices.size();
}

void FactoredSystem::finish() {
    std::vector<double> values = std::move(slices_sum_);
    Index inner = dim();
    for (std::size_t k = axes_.size(); k-- > 1;) {
        values = collocations_[k].apply_transposed_along(values, inner);
        inner *= axes_[k].free_count();
    }
    rhs_ = PointSet(std::move(values), dim());
}

void FactoredSystem::apply(const PointSet& x, PointSet& y) const {
    PointSet scratch;
    const PointSet* from = &x;
    Index inner = x.dim();
    for (std::size_t k = axes_.size(); k-- > 0;) {
        const Index n = axes_[k].free_count();
        const AxisLayout layout{static_cast<Index>(x.values().size()) / (n * inner), inner};
        if (k + 1 < axes_.size()) scratch = *from;
        grams_[k].apply(k + 1 < axes_.size() ? scratch.data() : from->data(), y.data(), layout);
        from = &y;
        inner *= n;
    }
}

std::vector<double> FactoredSystem::diagonal() const {
    std::vector<double> result{1.0};
    for (const BandedMatrix& gram : grams_) {
        std::vector<double> next;
        for (double outer : result)
            for (double inner : gram.diagonal()) next.push_back(outer * inner);
        result = std::move(next);
    }
    return result;
}

std::vector<const BandedMatrix*> FactoredSystem::factors() const {
    std::vector<const BandedMatrix*> result;
    for (const BandedMatrix& gram : grams_) result.push_back(&gram);
    return result;
}

} // namespace batten
