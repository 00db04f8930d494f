#include <batten/measure/curve_deviation.hpp>

#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>
#include <batten/samples/passes.hpp>
#include <batten/system/chebyshev_maps.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index block = 128;
constexpr Index most_dim = 16;

/// One polynomial piece: coefficients (degree + 1) x dim in T_k(s), relative to `centre`.
struct Piece {
    double middle;
    double scale;
    const double* coefficients;
    const double* centre;
    int degree;
    Index dim;
};

/// Parameters in [-1, 1] and coordinates relative to the centre of some samples, zero beyond them.
struct alignas(64) Planes {
    double s[block];
    double square[block];
    double point[most_dim][block];
};

/// Squares of a block's distances, degree and dimension known to the compiler so that all stays in
/// registers; 0: known only at run time.
template <int known_degree, int known_dim>
inline __attribute__((always_inline)) void
block_squares(const Piece& piece, const double* parameter, const double* point, Index count,
              Planes& planes) {
    const int degree = known_degree > 0 ? known_degree : piece.degree;
    const Index dim = known_dim > 0 ? known_dim : piece.dim;
    const Index padded = (count + lanes - 1) / lanes * lanes;
    for (Index j = 0; j < count; ++j) planes.s[j] = (parameter[j] - piece.middle) * piece.scale;
    for (Index j = 0; j < count; ++j)
        for (Index d = 0; d < dim; ++d) planes.point[d][j] = point[j * dim + d] - piece.centre[d];
    for (Index j = count; j < padded; ++j) {
        planes.s[j] = 0;
        for (Index d = 0; d < dim; ++d) planes.point[d][j] = 0;
    }
    for (Index j = 0; j < padded; j += lanes) {
        const LaneVector s = load(planes.s + j);
        const LaneVector twice = s + s;
        LaneVector square = s - s;
        for (Index d = 0; d < dim; ++d) {
            LaneVector before = s - s;
            LaneVector now = before;
            for (int k = degree; k >= 1; --k) { // Clenshaw's recurrence
                const LaneVector next = twice * now - before + piece.coefficients[k * dim + d];
                before = now;
                now = next;
            }
            const LaneVector gap =
                s * now - before + piece.coefficients[d] - load(planes.point[d] + j);
            square += gap * gap;
        }
        store(square, planes.square + j);
    }
}

BATTEN_VECTOR_CLONES
void piece_distances(const Piece& piece, const double* parameter, const double* point, Index count,
                     double* out) {
    Planes planes;
    for (Index first = 0; first < count; first += block) {
        const Index n = std::min(block, count - first);
        const double* t = parameter + first;
        const double* q = point + first * piece.dim;
        if (piece.degree == 3 && piece.dim == 3)
            block_squares<3, 3>(piece, t, q, n, planes);
        else if (piece.degree == 3 && piece.dim == 2)
            block_squares<3, 2>(piece, t, q, n, planes);
        else if (piece.degree == 3 && piece.dim == 1)
            block_squares<3, 1>(piece, t, q, n, planes);
        else
            block_squares<0, 0>(piece, t, q, n, planes);
        for (Index j = 0; j < n; ++j) out[first + j] = std::sqrt(planes.square[j]);
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

void curve_deviations(const Spline& curve, const double* points, std::span<const double> parameters,
                      double* out) {
    const KnotVector& knots = curve.axis(0);
    const double* t = parameters.data();
    const auto end = static_cast<Index>(parameters.size());
    for (Index i = 0; i < end;) {
        const double inside = knots.wrapped(t[i]);
        const double shift = t[i] - inside;
        const Index span = knots.span(inside);
        const Index stop =
            std::max<Index>(i + 1, std::lower_bound(t + i, t + end, knots[span + 1] + shift) - t);
        const ChebyshevMaps maps(knots, span);
        const std::vector<double> coefficients = piece_coefficients(curve, span, maps);
        const Piece piece{maps.middle() + shift, maps.scale(),
                          coefficients.data(),   curve.control_points()[0].data(),
                          knots.degree(),        curve.dim()};
        piece_distances(piece, t + i, points + i * curve.dim(), stop - i, out + i);
        i = stop;
    }
}

std::vector<double> curve_deviations(const Spline& curve, const Points& points,
                                     std::span<const double> parameters) {
    std::vector<double> result(static_cast<std::size_t>(points.size()));
    for_each_block(points.size(), chunk_samples, [&](const Block& block) {
        curve_deviations(curve, points.data() + block.begin * points.dim(),
                         parameters.subspan(static_cast<std::size_t>(block.begin),
                                            static_cast<std::size_t>(block.end - block.begin)),
                         result.data() + block.begin);
    });
    return result;
}

} // namespace batten
