#include <batten/measure/squared_distance.hpp>

#include <algorithm>
#include <cmath>
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

/// The products of the axes' binomials, last axis fastest.
template <class Use>
void for_each_binomial(const PerAxis<int>& degrees, const Use& use) {
    const auto& first = binomials[static_cast<std::size_t>(degrees[0])];
    const auto& second = binomials[static_cast<std::size_t>(degrees[1])];
    const auto& third = binomials[static_cast<std::size_t>(degrees[2])];
    Index k = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degrees[0]); ++i)
        for (std::size_t j = 0; j <= static_cast<std::size_t>(degrees[1]); ++j)
            for (std::size_t l = 0; l <= static_cast<std::size_t>(degrees[2]); ++l)
                use(k++, first[i] * second[j] * third[l]);
}

/// Adds the square of a polynomial with coefficients (rows0 x rows1 x length) in powers.
template <int length>
void add_square(const double* in, Index rows0, Index rows1, double* out) {
    constexpr Index wide = 2 * length - 1;
    for (Index a = 0; a < rows0 * rows1; ++a)
        for (Index b = a; b < rows0 * rows1; ++b) {
            const double factor = a == b ? 1 : 2; // a times b, and b times a
            double* row =
                out + ((a / rows1 + b / rows1) * (2 * rows1 - 1) + a % rows1 + b % rows1) * wide;
            for (Index i = 0; i < length; ++i) {
                const double x = factor * in[a * length + i];
                for (Index j = 0; j < length; ++j) row[i + j] += x * in[b * length + j];
            }
        }
}

constexpr std::array add_square_of_length{
    add_square<1>, add_square<2>, add_square<3>, add_square<4>, add_square<5>,
    add_square<6>, add_square<7>, add_square<8>, add_square<9>, add_square<10>};

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
    for_each_binomial(p, [&](Index k, double factor) {
        for (Index d = 0; d < dim; ++d)
            scaled_[static_cast<std::size_t>(d * n + k)] =
                factor * net.values[static_cast<std::size_t>(d * n + k)];
    });
    for (Index d = 0; d < dim; ++d)
        add_square_of_length[static_cast<std::size_t>(p[2])](scaled_.data() + d * n, p[0] + 1,
                                                             p[1] + 1, coefficients_.data());
    for_each_binomial({2 * p[0], 2 * p[1], 2 * p[2]}, [&](Index k, double factor) {
        coefficients_[static_cast<std::size_t>(k)] /= factor;
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
        if (up || down) return Face{a, up ? End::begin : End::end};
    }
    return std::nullopt;
}

} // namespace batten
