#include <batten/measure/net_model.hpp>

namespace batten {

namespace {

constexpr std::size_t most_order = max_degree + 1;
constexpr std::size_t most_coefficients = most_order * most_order * most_order;

/// A degree's Bernstein polynomials and their first two derivatives.
using Basis = std::array<std::array<double, most_order>, 3>;

Basis basis_at(int degree, double t) {
    Basis basis{};
    auto& [value, first, second] = basis;
    value[0] = 1;
    for (std::size_t q = 1; q <= static_cast<std::size_t>(degree); ++q)
        for (std::size_t k = q + 1; k-- > 0;) { // from degree q - 1, which has zeros beyond
            const double before = k > 0 ? value[k - 1] : 0;
            const double slope_before = k > 0 ? first[k - 1] : 0;
            second[k] = static_cast<double>(q) * (slope_before - first[k]);
            first[k] = static_cast<double>(q) * (before - value[k]);
            value[k] = t * before + (1 - t) * value[k];
        }
    return basis;
}

/// The value, the first derivatives, then the second derivatives of a point.
template <std::size_t axes>
constexpr std::size_t derivative_count = (axes + 1) * (axes + 2) / 2;

/// Their orders.
template <std::size_t axes>
constexpr auto derivative_orders = [] {
    std::array<PerAxis<std::size_t>, derivative_count<axes>> orders{};
    std::size_t c = 1;
    for (std::size_t a = 3 - axes; a < 3; ++a) orders[c++][a] = 1;
    for (std::size_t a = 3 - axes; a < 3; ++a)
        for (std::size_t b = a; b < 3; ++b, ++c) {
            ++orders[c][a];
            ++orders[c][b];
        }
    return orders;
}();

/// Writes the weights of every control point (coefficients x derivatives).
template <std::size_t axes>
void write_weights(const PerAxis<int>& degrees, const PerAxis<double>& at, double* weight) {
    const PerAxis<Basis> basis{basis_at(degrees[0], at[0]), basis_at(degrees[1], at[1]),
                               basis_at(degrees[2], at[2])};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degrees[0]); ++i)
        for (std::size_t j = 0; j <= static_cast<std::size_t>(degrees[1]); ++j)
            for (std::size_t k = 0; k <= static_cast<std::size_t>(degrees[2]); ++k)
                for (const PerAxis<std::size_t>& order : derivative_orders<axes>)
                    *weight++ =
                        basis[0][order[0]][i] * basis[1][order[1]][j] * basis[2][order[2]][k];
}

template <std::size_t axes>
NetModel model_of(const BezierNet& net, Index dim, const PerAxis<double>& at) {
    constexpr std::size_t count = derivative_count<axes>;
    std::array<double, most_coefficients * count> weights; // what is read is written first
    write_weights<axes>(net.degrees, at, weights.data());
    const Index n = net.coefficients();
    NetModel model;
    for (Index d = 0; d < dim; ++d) {
        std::array<double, count> point{};
        const double* weight = weights.data();
        for (Index i = 0; i < n; ++i, weight += count)
            for (std::size_t c = 0; c < count; ++c)
                point[c] += weight[c] * net.values[static_cast<std::size_t>(d * n + i)];
        model.square += point[0] * point[0];
        for (std::size_t a = 0, c = 1 + axes; a < axes; ++a) {
            model.gradient[3 - axes + a] += point[0] * point[1 + a];
            for (std::size_t b = a; b < axes; ++b, ++c) {
                const double slopes = point[1 + a] * point[1 + b];
                model.without_bend[3 - axes + b][3 - axes + a] += slopes;
                model.hessian[3 - axes + b][3 - axes + a] += slopes + point[0] * point[c];
            }
        }
    }
    return model;
}

} // namespace

NetModel model_at(const BezierNet& net, Index axis_count, Index dim, const PerAxis<double>& at) {
    if (axis_count == 1) return model_of<1>(net, dim, at);
    if (axis_count == 2) return model_of<2>(net, dim, at);
    return model_of<3>(net, dim, at);
}

} // namespace batten
