#include <batten/basis/basis_functions.hpp>

namespace batten {

namespace {

/// B-splines of degree p (at most knots.degree()) that do not vanish on the span.
BasisValues values_of_degree(const KnotVector& knots, Index span, double t, int p) {
    BasisValues value{};
    std::array<double, max_degree + 1> left{};
    std::array<double, max_degree + 1> right{};
    value[0] = 1;
    for (std::size_t j = 1; j <= static_cast<std::size_t>(p); ++j) {
        left[j] = t - knots[span + 1 - static_cast<Index>(j)];
        right[j] = knots[span + static_cast<Index>(j)] - t;
        double saved = 0;
        for (std::size_t r = 0; r < j; ++r) {
            const double share = value[r] / (right[r + 1] + left[j - r]);
            value[r] = saved + right[r + 1] * share;
            saved = left[j - r] * share;
        }
        value[j] = saved;
    }
    return value;
}

} // namespace

BasisValues basis_values(const KnotVector& knots, Index span, double t) {
    return values_of_degree(knots, span, t, knots.degree());
}

BasisValues basis_derivatives(const KnotVector& knots, Index span, double t, int order) {
    const int p = knots.degree();
    if (order > p) return BasisValues{};
    // B'_{i,q} = q (B_{i,q-1} / (t_{i+q} - t_i) - B_{i+1,q-1} / (t_{i+q+1} - t_{i+1})), degree by
    // degree
    BasisValues value = values_of_degree(knots, span, t, p - order);
    for (int q = p - order + 1; q <= p; ++q) {
        BasisValues next{};
        for (int r = 0; r <= q; ++r) {
            const Index i = span - q + r;
            double sum = 0;
            if (r > 0) sum += value[static_cast<std::size_t>(r - 1)] / (knots[i + q] - knots[i]);
            if (r < q)
                sum -= value[static_cast<std::size_t>(r)] / (knots[i + q + 1] - knots[i + 1]);
            next[static_cast<std::size_t>(r)] = q * sum;
        }
        value = next;
    }
    return value;
}

std::vector<double> greville_abscissae(const KnotVector& knots) {
    std::vector<double> result;
    for (Index i = 0; i < knots.control_count(); ++i) {
        double sum = 0;
        for (Index k = i + 1; k <= i + knots.degree(); ++k) sum += knots[k];
        result.push_back(sum / knots.degree());
    }
    return result;
}

} // namespace batten
