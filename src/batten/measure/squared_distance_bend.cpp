#include <batten/measure/squared_distance.hpp>

#include <algorithm>
#include <limits>

namespace batten {

namespace {

/// The derivative along an axis as a polynomial of the same degree, so that derivatives along
/// different axes can be combined coefficient by coefficient.
void differentiate(const std::vector<double>& in, Index step, Index order,
                   std::vector<double>& out) {
    const auto m = static_cast<Index>(in.size());
    out.resize(in.size());
    for (Index first = 0; first < m; first += step * order)
        for (Index k = 0; k < order; ++k) {
            const auto before = static_cast<double>(k); // degree elevation's weights
            const auto after = static_cast<double>(order - 1 - k);
            for (Index i = first + k * step; i < first + (k + 1) * step; ++i) {
                const double* c = in.data() + i;
                double slope = k > 0 ? before * (c[0] - c[-step]) : 0;
                if (k + 1 < order) slope += after * (c[step] - c[0]);
                out[static_cast<std::size_t>(i)] = slope;
            }
        }
}

/// Whether the symmetric matrix, of which the upper half is read, is positive definite by its
/// leading minors, certainly.
bool is_positive_definite(const AxisMatrix& h) {
    constexpr double rounding = 1e-14;
    const double minor = h[0][0] * h[1][1] - h[0][1] * h[0][1];
    if (!(h[0][0] > 0 && h[1][1] > 0 && h[2][2] > 0 && minor > rounding * h[0][0] * h[1][1]))
        return false;
    const double determinant = minor * h[2][2] - h[0][0] * h[1][2] * h[1][2] -
                               h[1][1] * h[0][2] * h[0][2] + 2 * h[0][1] * h[0][2] * h[1][2];
    return determinant > rounding * h[0][0] * h[1][1] * h[2][2];
}

} // namespace

double SquaredDistance::least_curvature(std::size_t axis) const {
    const auto m = static_cast<Index>(coefficients_.size());
    const Index step = stride(axis);
    const Index block = step * order_[axis];
    double least = std::numeric_limits<double>::infinity();
    for (Index first = 0; first < m; first += block)
        for (Index i = first; i < first + block - 2 * step; ++i) {
            const double* c = coefficients_.data() + i;
            least = std::min(least, c[2 * step] - 2 * c[step] + c[0]);
        }
    return static_cast<double>((order_[axis] - 1) * (order_[axis] - 2)) * (least - 4 * allowance_);
}

bool SquaredDistance::is_convex() {
    Index axes = 0;
    std::size_t last = 0;
    Index steepest = 0; // degree of the squared distance
    for (std::size_t a = 0; a < 3; ++a) {
        if (order_[a] == 1) continue;
        ++axes;
        last = a;
        steepest = std::max(steepest, order_[a] - 1);
    }
    if (axes == 1) return least_curvature(last) > 0;
    find_hessian();
    // each derivative takes differences twice; three entries of an error may add up in a row
    const double degree = static_cast<double>(steepest);
    const double error = 3 * 4 * degree * degree * allowance_;
    for (std::size_t k = 0; k < coefficients_.size(); ++k) {
        AxisMatrix h{};
        for (std::size_t a = 0; a < 3; ++a) {
            h[a][a] = order_[a] > 1 ? hessian_[a][a][k] - error : 1;
            for (std::size_t b = a + 1; b < 3; ++b)
                h[a][b] = order_[a] > 1 && order_[b] > 1 ? hessian_[a][b][k] : 0;
        }
        if (!is_positive_definite(h)) return false;
    }
    return true;
}

void SquaredDistance::find_hessian() {
    for (std::size_t a = 0; a < 3; ++a) {
        if (order_[a] == 1) continue;
        differentiate(coefficients_, stride(a), order_[a], slope_);
        for (std::size_t b = a; b < 3; ++b)
            if (order_[b] > 1) differentiate(slope_, stride(b), order_[b], hessian_[a][b]);
    }
}

} // namespace batten
