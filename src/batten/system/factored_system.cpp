#include <batten/system/factored_system.hpp>

#include <batten/system/roughness.hpp>

namespace batten {

namespace {

/// Entries of the Kronecker product of the factors, times `value`, in the block of `row` and
/// `column`.
void visit_product(std::span<const BandedMatrix* const> factors, Index row, Index column,
                   double value, const NormalSystem::EntryVisitor& visit) {
    if (factors.empty()) return visit(row, column, value);
    const BandedMatrix& first = *factors[0];
    first.for_each_entry([&](Index i, Index j, double entry) {
        visit_product(factors.subspan(1), row * first.size() + i, column * first.size() + j,
                      value * entry, visit);
    });
}

} // namespace

FactoredSystem::FactoredSystem(std::vector<KnotVector> axes, std::vector<double> centre)
    : NormalSystem(std::move(axes), std::move(centre)) {
    for (const KnotVector& axis : axes_)
        grams_.emplace_back(axis.free_count(), axis.degree(), axis.closure());
}

FactoredSystem::FactoredSystem(SystemSums sums)
    : NormalSystem(std::move(sums)), grams_(std::move(sums.factors)) {}

SystemSums FactoredSystem::sums() const {
    SystemSums result = NormalSystem::common_sums();
    result.weight = 1;
    for (const BandedMatrix& gram : grams_) result.weight *= gram.total();
    result.factors = grams_;
    return result;
}

void FactoredSystem::apply(const PointSet& x, PointSet& y) const {
    const std::size_t last = axes_.size() - 1;
    grams_[last].apply(x.data(), y.data(), along(controls_, last, x.dim()));
    PointSet before;
    for (std::size_t k = last; k-- > 0;) {
        before = y;
        grams_[k].apply(before.data(), y.data(), along(controls_, k, x.dim()));
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

void FactoredSystem::add_roughness(double lambda, int order) {
    for (std::size_t k = 0; k < grams_.size(); ++k)
        grams_[k].add(lambda * grams_[k].total(),
                      unit_roughness_matrix(axes_[k], order)); // B-splines sum to one
}

void FactoredSystem::for_each_entry(EntryVisitor visit) const {
    visit_product(factors(), 0, 0, 1, visit);
}

} // namespace batten
