#include <batten/measure/bezier_net.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Splits (outer x order x inner) control points in their middle by de Casteljau's algorithm: the
/// first half takes their place, the second goes to `second`.
void split(double* first, double* second, Index outer, Index order, Index inner) {
    const Index block = order * inner;
    for (Index o = 0; o < outer; ++o, first += block, second += block)
        for (Index level = 0; level < order; ++level) {
            for (Index r = order - 1; level > 0 && r >= level; --r)
                for (Index k = r * inner; k < (r + 1) * inner; ++k)
                    first[k] = (first[k - inner] + first[k]) / 2;
            std::copy_n(first + block - inner, inner, second + block - (level + 1) * inner);
        }
}

} // namespace

Index BezierNet::stride(std::size_t axis) const {
    Index result = 1;
    for (std::size_t a = axis + 1; a < 3; ++a) result *= degrees[a] + 1;
    return result;
}

PerAxis<double> BezierNet::in_piece(const PerAxis<double>& local) const {
    PerAxis<double> place{};
    for (std::size_t a = 0; a < 3; ++a) place[a] = begin[a] + width[a] * local[a];
    return place;
}

PerAxis<double> BezierNet::in_net(const PerAxis<double>& place) const {
    PerAxis<double> local{};
    for (std::size_t a = 0; a < 3; ++a)
        if (degrees[a] > 0) local[a] = std::clamp((place[a] - begin[a]) / width[a], 0.0, 1.0);
    return local;
}

bool BezierNet::contains(const PerAxis<double>& place) const {
    for (std::size_t a = 0; a < 3; ++a)
        if (!(place[a] >= begin[a] && place[a] <= begin[a] + width[a])) return false;
    return true;
}

PerAxis<double> extents(const BezierNet& net, Index dim) {
    PerAxis<double> result{};
    const Index n = net.coefficients();
    for (std::size_t a = 0; a < 3; ++a) {
        const Index stride = net.stride(a);
        const Index block = stride * (net.degrees[a] + 1);
        double longest = 0;
        for (Index first = 0; first < n; first += block)
            for (Index i = first; i < first + block - stride; ++i) {
                double square = 0;
                for (Index d = 0; d < dim; ++d) {
                    const double* value = net.values.data() + d * n + i;
                    square += (value[stride] - value[0]) * (value[stride] - value[0]);
                }
                longest = std::max(longest, square);
            }
        result[a] = net.degrees[a] * std::sqrt(longest);
    }
    return result;
}

double box_square(const BezierNet& net, Index dim) {
    const Index n = net.coefficients();
    double square = 0;
    for (const double* value = net.values.data(); dim > 0; --dim, value += n) {
        double low = value[0];
        double high = value[0];
        for (Index i = 1; i < n; ++i) {
            low = value[i] < low ? value[i] : low;
            high = value[i] > high ? value[i] : high;
        }
        const double gap = std::max({low, -high, 0.0});
        square += gap * gap;
    }
    return square;
}

void collapse(BezierNet& net, Index dim, const Face& face) {
    const Index inner = net.stride(face.axis);
    const Index order = net.degrees[face.axis] + 1;
    const Index rows = dim * net.coefficients() / (order * inner);
    const Index offset = face.end == AxisEnd::begin ? 0 : (order - 1) * inner;
    for (Index row = 0; row < rows; ++row) // moves to the left only
        std::copy_n(net.values.data() + row * order * inner + offset, inner,
                    net.values.data() + row * inner);
    if (face.end == AxisEnd::end) net.begin[face.axis] += net.width[face.axis];
    net.width[face.axis] = 0;
    net.degrees[face.axis] = 0;
}

void halve(BezierNet& net, Index dim, std::size_t axis, AxisEnd kept, BezierNet& rest) {
    const Index inner = net.stride(axis);
    const Index order = net.degrees[axis] + 1;
    rest.degrees = net.degrees;
    net.width[axis] /= 2;
    rest.begin = net.begin;
    rest.width = net.width;
    rest.values.resize(net.values.size());
    split(net.values.data(), rest.values.data(), dim * net.coefficients() / (order * inner), order,
          inner);
    rest.begin[axis] += rest.width[axis];
    if (kept == AxisEnd::end) std::swap(net, rest);
}

} // namespace batten
