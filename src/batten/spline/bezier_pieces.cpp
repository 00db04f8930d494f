#include <batten/spline/bezier_pieces.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr int most_order = max_degree + 1;
constexpr std::size_t most_coefficients = most_order * most_order * most_order;

/// Appends the map from the degree + 1 control points of `span` to its Bezier control points: row j
/// holds the blossom of each B-spline with j arguments at the span's end, the others at its begin.
void append_map(const KnotVector& knots, Index span, std::vector<double>& maps) {
    const int p = knots.degree();
    for (int j = 0; j <= p; ++j) {
        std::array<std::array<double, most_order>, most_order> row{};
        for (int r = 0; r <= p; ++r)
            row[static_cast<std::size_t>(r)][static_cast<std::size_t>(r)] = 1;
        for (int level = 1; level <= p; ++level) {
            const double argument = level <= p - j ? knots[span] : knots[span + 1];
            for (int r = p; r >= level; --r) {
                const double low = knots[span - p + r];
                const double high = knots[span + 1 + r - level];
                const double alpha = (argument - low) / (high - low);
                auto& here = row[static_cast<std::size_t>(r)];
                const auto& before = row[static_cast<std::size_t>(r - 1)];
                for (std::size_t k = 0; k < most_order; ++k)
                    here[k] = (1 - alpha) * before[k] + alpha * here[k];
            }
        }
        const auto& result = row[static_cast<std::size_t>(p)];
        maps.insert(maps.end(), result.begin(), result.begin() + p + 1);
    }
}

/// Applies the map (order x order) along the middle of (outer x order x inner) values.
void apply_map(const double* map, Index outer, Index order, Index inner, const double* in,
               double* out) {
    for (Index o = 0; o < outer; ++o, in += order * inner)
        for (Index j = 0; j < order; ++j, out += inner) {
            const double* row = map + j * order;
            for (Index k = 0; k < inner; ++k) out[k] = row[0] * in[k];
            for (Index r = 1; r < order; ++r)
                for (Index k = 0; k < inner; ++k) out[k] += row[r] * in[r * inner + k];
        }
}

} // namespace

BezierPieces::BezierPieces(const Spline& spline)
    : axis_count_(spline.axis_count()), dim_(spline.dim()) {
    Index stride = 1;
    for (std::size_t a = 3; a-- > 3 - static_cast<std::size_t>(axis_count_);) {
        Axis& axis = axes_[a];
        axis.knots = spline.axis(static_cast<Index>(a) - 3 + axis_count_);
        axis.breaks = axis.knots.breakpoints();
        axis.stride = stride;
        stride *= axis.knots.control_count();
        degrees_[a] = axis.knots.degree();
        shape_[a] = static_cast<Index>(axis.breaks.size()) - 1;
        for (Index k = 0; k < shape_[a]; ++k) {
            const Index span = axis.knots.span(axis.breaks[static_cast<std::size_t>(k)]);
            axis.first.push_back(span - degrees_[a]);
            append_map(axis.knots, span, axis.maps);
        }
    }
    normalise(spline.control_points());
}

void BezierPieces::normalise(const PointSet& control) {
    for (Index d = 0; d < dim_; ++d) {
        double low = control(0, d);
        double high = low;
        for (Index i = 1; i < control.size(); ++i) {
            low = std::min(low, control(i, d));
            high = std::max(high, control(i, d));
        }
        origin_.push_back(low / 2 + high / 2);
        size_ = std::max(size_, high - low);
    }
    if (size_ > 0) exponent_ = -std::ilogb(size_);
    size_ = std::scalbn(size_, exponent_);
    control_.resize(static_cast<std::size_t>(control.size() * dim_));
    double* out = control_.data();
    for (Index d = 0; d < dim_; ++d)
        for (Index i = 0; i < control.size(); ++i)
            *out++ = std::scalbn(control(i, d) - origin_[static_cast<std::size_t>(d)], exponent_);
}

Index BezierPieces::coefficients() const {
    return (degrees_[0] + 1) * (degrees_[1] + 1) * (degrees_[2] + 1);
}

PerAxis<Index> BezierPieces::along_axes(Index piece) const {
    const Index row = piece / shape_[2];
    return {row / shape_[1], row % shape_[1], piece % shape_[2]};
}

void BezierPieces::load(Index piece, std::span<double> net) const {
    const PerAxis<Index> at = along_axes(piece);
    const PerAxis<Index> order{degrees_[0] + 1, degrees_[1] + 1, degrees_[2] + 1};
    const Index n = coefficients();
    const Index total = static_cast<Index>(control_.size()) / dim_;
    Index first = 0;
    for (std::size_t a = 3 - static_cast<std::size_t>(axis_count_); a < 3; ++a)
        first += axes_[a].first[static_cast<std::size_t>(at[a])] * axes_[a].stride;
    std::array<double, most_coefficients> gathered; // every entry that is read is written first
    std::array<double, most_coefficients> mapped;
    for (Index d = 0; d < dim_; ++d) {
        double* now = gathered.data();
        double* next = mapped.data();
        const double* corner = control_.data() + d * total + first;
        for (Index i = 0, k = 0; i < order[0]; ++i)
            for (Index j = 0; j < order[1]; ++j, k += order[2])
                std::copy_n(corner + i * axes_[0].stride + j * axes_[1].stride, order[2], now + k);
        for (std::size_t a = 3 - static_cast<std::size_t>(axis_count_); a < 3; ++a) {
            const Index inner = a == 0 ? order[1] * order[2] : a == 1 ? order[2] : 1;
            apply_map(axes_[a].maps.data() + at[a] * order[a] * order[a], n / (order[a] * inner),
                      order[a], inner, now, next);
            std::swap(now, next);
        }
        std::copy_n(now, n, net.data() + d * n);
    }
}

void BezierPieces::localise(std::span<const double> point, std::span<double> local) const {
    for (std::size_t d = 0; d < origin_.size(); ++d)
        local[d] = std::scalbn(point[d] - origin_[d], exponent_);
}

double BezierPieces::in_own_units(double length) const {
    return std::scalbn(length, -exponent_);
}

std::vector<double> BezierPieces::parameter(const PlaceInPiece& place) const {
    const PerAxis<Index> at = along_axes(place.piece);
    std::vector<double> result;
    for (std::size_t a = 3 - static_cast<std::size_t>(axis_count_); a < 3; ++a) {
        const auto k = static_cast<std::size_t>(at[a]);
        result.push_back(std::lerp(axes_[a].breaks[k], axes_[a].breaks[k + 1], place.local[a]));
    }
    return result;
}

PlaceInPiece BezierPieces::place(std::span<const double> parameter) const {
    PlaceInPiece result;
    for (std::size_t a = 3 - static_cast<std::size_t>(axis_count_), k = 0; a < 3; ++a, ++k) {
        const std::vector<double>& breaks = axes_[a].breaks;
        const double t =
            std::clamp(axes_[a].knots.wrapped(parameter[k]), breaks.front(), breaks.back());
        const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, t);
        result.piece = result.piece * shape_[a] + (after - breaks.begin() - 1);
        result.local[a] = (t - *(after - 1)) / (*after - *(after - 1));
    }
    return result;
}

} // namespace batten
