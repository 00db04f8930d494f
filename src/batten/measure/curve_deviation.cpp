#include <batten/measure/curve_deviation.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/system/chebyshev_maps.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index block_samples = 1 << 14;
constexpr Index block = 128;

/// One polynomial piece: coefficients (degree + 1) x dim in T_k(s), relative to `centre`.
struct Piece {
    double middle;
    double scale;
    const double* coefficients;
    const double* centre;
    int degree;
    Index dim;
};

BATTEN_VECTOR_CLONES
void piece_distances(const Piece& piece, const double* parameter, const double* point, Index count,
                     double* out) {
    double s[block];
    double before[block];
    double now[block];
    double square[block];
    for (Index first = 0; first < count; first += block) {
        const Index n = std::min(block, count - first);
        for (Index j = 0; j < n; ++j)
            s[j] = 2 * (parameter[first + j] - piece.middle) * piece.scale;
        for (Index j = 0; j < n; ++j) square[j] = 0;
        for (Index d = 0; d < piece.dim; ++d) {
            for (Index j = 0; j < n; ++j) before[j] = now[j] = 0;
            for (int k = piece.degree; k >= 1; --k) { // Clenshaw's recurrence
                const double c = piece.coefficients[k * piece.dim + d];
                for (Index j = 0; j < n; ++j) {
                    const double next = s[j] * now[j] - before[j] + c;
                    before[j] = now[j];
                    now[j] = next;
                }
            }
            const double c = piece.coefficients[d];
            const double* q = point + first * piece.dim + d;
            for (Index j = 0; j < n; ++j) {
                const double gap =
                    s[j] / 2 * now[j] - before[j] + c - (q[j * piece.dim] - piece.centre[d]);
                square[j] += gap * gap;
            }
        }
        for (Index j = 0; j < n; ++j) out[first + j] = std::sqrt(square[j]);
    }
}

/// Coefficients of the piece over `span`.
std::vector<double> piece_coefficients(const Spline& curve, Index span, const ChebyshevMaps& maps) {
    const int p = curve.axis(0).degree();
    const Index dim = curve.dim();
    std::vector<double> result(static_cast<std::size_t>((p + 1) * dim));
    for (int i = 0; i <= p; ++i)
        for (int k = 0; k <= p; ++k)
            for (Index d = 0; d < dim; ++d)
                result[static_cast<std::size_t>(k * dim + d)] +=
                    maps.coefficients(i)[k] *
                    (curve.control_points()(span - p + i, d) - curve.control_points()(0, d));
    return result;
}

} // namespace

std::vector<double> curve_deviations(const Spline& curve, const Points& points,
                                     std::span<const double> parameters) {
    const KnotVector& knots = curve.axis(0);
    const Index m = points.size();
    std::vector<double> result(static_cast<std::size_t>(m));
    for_each_block(m, block_samples, [&](const Block& samples) {
        const Index end = samples.end;
        const double* t = parameters.data();
        for (Index i = samples.begin; i < end;) {
            const double inside = knots.wrapped(t[i]);
            const double shift = t[i] - inside;
            const Index span = knots.span(inside);
            const Index stop = std::max<Index>(
                i + 1, std::lower_bound(t + i, t + end, knots[span + 1] + shift) - t);
            const ChebyshevMaps maps(knots, span);
            const std::vector<double> coefficients = piece_coefficients(curve, span, maps);
            const Piece piece{maps.middle() + shift, maps.scale(),
                              coefficients.data(),   curve.control_points()[0].data(),
                              knots.degree(),        curve.dim()};
            piece_distances(piece, t + i, points.data() + i * curve.dim(), stop - i,
                            result.data() + i);
            i = stop;
        }
    });
    return result;
}

} // namespace batten
