#include <batten/system/row_sums.hpp>

#include <cmath>

namespace batten {

std::vector<double> row_sums(const BandedMatrix& matrix) {
    std::vector<double> sums(static_cast<std::size_t>(matrix.size()), 0);
    matrix.for_each_entry([&](Index row, Index, double value) {
        sums[static_cast<std::size_t>(row)] += std::abs(value);
    });
    return sums;
}

std::vector<double> row_sums(const NormalSystem& system) {
    const auto factors = system.factors();
    if (factors.empty()) {
        std::vector<double> sums(static_cast<std::size_t>(system.size()), 0);
        system.for_each_entry([&](Index row, Index, double value) {
            sums[static_cast<std::size_t>(row)] += std::abs(value);
        });
        return sums;
    }
    std::vector<double> product{1};
    for (const BandedMatrix* factor : factors) {
        const std::vector<double> axis = row_sums(*factor);
        std::vector<double> next;
        next.reserve(product.size() * axis.size());
        for (double outer : product)
            for (double inner : axis) next.push_back(outer * inner);
        product = std::move(next);
    }
    return product;
}

} // namespace batten
