#include <batten/measure/squared_distance.hpp>

#include <batten/core/vector_clones.hpp>

#include <algorithm>
#include <limits>

namespace batten {

namespace {

constexpr int most_degree = 2 * max_degree;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

constexpr auto binomials = [] {
    std::array<std::array<double, most_degree + 1>, most_degree + 1> table{};
    for (std::size_t n = 0; n <= most_degree; ++n) {
        table[n][0] = 1;
        for (std::size_t k = 1; k <= n; ++k) table[n][k] = table[n - 1][k - 1] + table[n - 1][k];
    }
    return table;
}();

constexpr auto reciprocals = [] {
    auto table = binomials;
    for (std::size_t n = 0; n <= most_degree; ++n)
        for (std::size_t k = 0; k <= n; ++k) table[n][k] = 1 / table[n][k];
    return table;
}();

/// The products of the axes' binomials, or of their reciprocals, last axis fastest.
template <class Use>
void for_each_product(const decltype(binomials)& table, const PerAxis<int>& degrees,
                      const Use& use) {
    const auto& first = table[static_cast<std::size_t>(degrees[0])];
    const auto& second = table[static_cast<std::size_t>(degrees[1])];
    const auto& third = table[static_cast<std::size_t>(degrees[2])];
    Index k = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degrees[0]); ++i)
        for (std::size_t j = 0; j <= static_cast<std::size_t>(degrees[1]); ++j)
            for (std::size_t l = 0; l <= static_cast<std::size_t>(degrees[2]); ++l)
                use(k++, first[i] * second[j] * third[l]);
}

/// Coordinates' coefficients in powers: dim x (rows0 x rows1 x length).
struct Factors {
    const double* values;
    Index dim;
    Index rows0;
    Index rows1;
};

/// Adds both products of two rows, summed over the coordinates, or the one of a row with itself.
template <int length>
inline __attribute__((always_inline)) void add_product(const Factors& f, Index a, Index b,
                                                       double* out) {
    std::array<double, 2 * length - 1> sum{};
    const Index plane = f.rows0 * f.rows1 * length;
    for (Index d = 0; d < f.dim; ++d) {
        const double* x = f.values + d * plane + a * length;
        const double* y = f.values + d * plane + b * length;
        for (std::size_t i = 0; i < length; ++i)
            for (std::size_t j = 0; j < length; ++j) sum[i + j] += x[i] * y[j];
    }
    const double factor = a == b ? 1 : 2;
    for (std::size_t k = 0; k < sum.size(); ++k) out[k] += factor * sum[k];
}

/// Adds the square, (2 rows0 - 1) x (2 rows1 - 1) x (2 length - 1).
template <int length>
inline __attribute__((always_inline)) void add_square(const Factors& f, double* out) {
    for (Index a0 = 0; a0 < f.rows0; ++a0)
        for (Index a1 = 0; a1 < f.rows1; ++a1)
            for (Index b0 = a0; b0 < f.rows0; ++b0)
                for (Index b1 = b0 == a0 ? a1 : 0; b1 < f.rows1; ++b1)
                    add_product<length>(f, a0 * f.rows1 + a1, b0 * f.rows1 + b1,
                                        out + ((a0 + b0) * (2 * f.rows1 - 1) + a1 + b1) *
                                                  (2 * length - 1));
}

BATTEN_VECTOR_CLONES
void add_square_of(int length, const Factors& f, double* out) {
    switch (length) {
    case 1:
        return add_square<1>(f, out);
    case 2:
        return add_square<2>(f, out);
    case 3:
        return add_square<3>(f, out);
    case 4:
        return add_square<4>(f, out);
    case 5:
        return add_square<5>(f, out);
    case 6:
        return add_square<6>(f, out);
    case 7:
        return add_square<7>(f, out);
    case 8:
        return add_square<8>(f, out);
    case 9:
        return add_square<9>(f, out);
    default:
        return add_square<10>(f, out);
    }
}

} // namespace

void SquaredDistance::assign(const BezierNet& net, Index dim) {
    square_points(net, dim);
    multiply(net, dim);
    const Index m = order_[0] * order_[1] * order_[2];
    const double* smallest = std::min_element(coefficients_.data(), coefficients_.data() + m);
    least_ = *smallest;
    least_index_ = smallest - coefficients_.data();
}

void SquaredDistance::square_points(const BezierNet& net, Index dim) {
    const Index n = net.coefficients();
    const PerAxis<int>& p = net.degrees;
    double largest = 0;
    least_corner_ = std::numeric_limits<double>::infinity();
    Index at = 0;
    for (int i = 0; i <= p[0]; ++i)
        for (int j = 0; j <= p[1]; ++j)
            for (int k = 0; k <= p[2]; ++k, ++at) {
                double square = 0;
                for (Index d = 0; d < dim; ++d) {
                    const double x = net.values[static_cast<std::size_t>(d * n + at)];
                    square += x * x;
                }
                largest = std::max(largest, square);
                const bool corner = i % std::max(p[0], 1) == 0 && j % std::max(p[1], 1) == 0 &&
                                    k % std::max(p[2], 1) == 0;
                if (corner && square < least_corner_) {
                    least_corner_ = square;
                    corner_ = {i > 0 ? 1.0 : 0.0, j > 0 ? 1.0 : 0.0, k > 0 ? 1.0 : 0.0};
                }
            }
    // a coefficient is a mean, with positive weights, of n dim products at most
    allowance_ = static_cast<double>(n * dim + 16) * epsilon * largest;
}

void SquaredDistance::multiply(const BezierNet& net, Index dim) {
    const PerAxis<int>& p = net.degrees;
    const Index n = net.coefficients();
    for (std::size_t a = 0; a < 3; ++a) order_[a] = 2 * p[a] + 1;
    scaled_.resize(net.values.size());
    coefficients_.assign(static_cast<std::size_t>(order_[0] * order_[1] * order_[2]), 0);
    for_each_product(binomials, p, [&](Index k, double factor) {
        for (Index d = 0; d < dim; ++d)
            scaled_[static_cast<std::size_t>(d * n + k)] =
                factor * net.values[static_cast<std::size_t>(d * n + k)];
    });
    add_square_of(p[2] + 1, {scaled_.data(), dim, p[0] + 1, p[1] + 1}, coefficients_.data());
    for_each_product(reciprocals, {2 * p[0], 2 * p[1], 2 * p[2]}, [&](Index k, double factor) {
        coefficients_[static_cast<std::size_t>(k)] *= factor;
    });
}

Index SquaredDistance::stride(std::size_t axis) const {
    Index result = 1;
    for (std::size_t a = axis + 1; a < 3; ++a) result *= order_[a];
    return result;
}

PerAxis<double> SquaredDistance::least_at() const {
    PerAxis<double> at{};
    Index rest = least_index_;
    for (std::size_t a = 3; a-- > 0;) {
        if (order_[a] > 1)
            at[a] = static_cast<double>(rest % order_[a]) / static_cast<double>(order_[a] - 1);
        rest /= order_[a];
    }
    return at;
}

std::optional<Face> SquaredDistance::downhill_face() const {
    const auto m = static_cast<Index>(coefficients_.size());
    const double least_step = 2 * allowance_;
    for (std::size_t a = 0; a < 3; ++a) {
        if (order_[a] == 1) continue;
        const Index step = stride(a);
        const Index block = step * order_[a];
        bool up = true;
        bool down = true;
        for (Index first = 0; first < m && (up || down); first += block)
            for (Index i = first; i < first + block - step; ++i) {
                const double* c = coefficients_.data() + i;
                const double slope = c[step] - c[0];
                up = up && slope > least_step;
                down = down && slope < -least_step;
            }
        if (up || down) return Face{a, up ? AxisEnd::begin : AxisEnd::end};
    }
    return std::nullopt;
}

} // namespace batten
