#include <batten/system/factored_system.hpp>

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

void FactoredSystem::for_each_entry(EntryVisitor visit) const {
    visit_product(factors(), 0, 0, 1, visit);
}

} // namespace batten
