#include <batten/solve/condition.hpp>

#include <cmath>

namespace batten {

double inverse_norm(const NormalSystem& system, const Factorization& factorization) {
    constexpr int most_rounds = 5;
    const Index n = system.size();
    std::vector<double> root = system.diagonal();
    for (double& x : root) x = std::sqrt(x);
    const auto inverse = [&](PointSet x) {
        for (Index i = 0; i < n; ++i) x(i, 0) *= root[static_cast<std::size_t>(i)];
        x = factorization.solve(std::move(x));
        for (Index i = 0; i < n; ++i) x(i, 0) *= root[static_cast<std::size_t>(i)];
        return x;
    };
    PointSet x(n, 1);
    x.fill(1 / static_cast<double>(n));
    double norm = 0;
    for (int round = 0; round < most_rounds; ++round) {
        const PointSet y = inverse(x);
        double sum = 0;
        PointSet signs(n, 1);
        for (Index i = 0; i < n; ++i) {
            sum += std::abs(y(i, 0));
            signs(i, 0) = std::copysign(1.0, y(i, 0));
        }
        if (round > 0 && !(sum > norm)) break;
        norm = sum;
        const PointSet z = inverse(std::move(signs));
        Index steepest = 0;
        for (Index i = 1; i < n; ++i)
            if (std::abs(z(i, 0)) > std::abs(z(steepest, 0))) steepest = i;
        if (std::abs(z(steepest, 0)) <= inner_product(z, x)) break;
        x.fill(0);
        x(steepest, 0) = 1;
    }
    return norm;
}

} // namespace batten
