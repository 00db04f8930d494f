#include <batten/system/moments.hpp>

#include <batten/basis/knot_vector.hpp>
#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>

#include <algorithm>

namespace batten {

namespace {

constexpr Index block = 128;
constexpr Index most_dim = 16;

/// Planes of a block of samples: the parameter in [-1, 1], the weight, the coordinates; zero beyond
/// the block's end.
struct alignas(64) Planes {
    double s[block];
    double weight[block];
    double point[most_dim][block];
};

template <int dim>
inline __attribute__((always_inline)) void split_points(const double* point, Index count,
                                                        const double* centre, Planes& planes) {
    for (Index j = 0; j < count; ++j)
        for (int d = 0; d < dim; ++d) planes.point[d][j] = point[j * dim + d] - centre[d];
}

inline __attribute__((always_inline)) void
split_points_of(Index dim, const double* point, Index count, const double* centre, Planes& planes) {
    switch (dim) {
    case 1:
        return split_points<1>(point, count, centre, planes);
    case 2:
        return split_points<2>(point, count, centre, planes);
    case 3:
        return split_points<3>(point, count, centre, planes);
    default:
        for (Index j = 0; j < count; ++j)
            for (Index d = 0; d < dim; ++d) planes.point[d][j] = point[j * dim + d] - centre[d];
    }
}

/// Sums of one block, degree and dimension known to the compiler so that they stay in registers; 0:
/// known only at run time.
template <int known_degree, int known_dim>
inline __attribute__((always_inline)) void add_block(const Planes& planes, Index padded,
                                                     int degree_, Index dim_, Lanes* moments,
                                                     Lanes* values, Lanes* energy) {
    const int degree = known_degree > 0 ? known_degree : degree_;
    const Index dim = known_dim > 0 ? known_dim : dim_;
    constexpr int moment_room = known_degree > 0 ? 2 * known_degree + 1 : 2 * max_degree + 1;
    constexpr int value_room = known_degree > 0 && known_dim > 0
                                   ? (known_degree + 1) * known_dim
                                   : (max_degree + 1) * static_cast<int>(most_dim);
    LaneVector m[moment_room];
    LaneVector v[value_room];
    for (int k = 0; k <= 2 * degree; ++k) m[k] = load(moments[k].value.data());
    for (Index k = 0; k < (degree + 1) * dim; ++k) v[k] = load(values[k].value.data());
    LaneVector e = load(energy->value.data());
    for (Index j = 0; j < padded; j += lanes) {
        const LaneVector s = load(planes.s + j);
        const LaneVector twice = s + s;
        LaneVector before = load(planes.weight + j);
        LaneVector now = before * s;
        for (Index d = 0; d < dim; ++d) {
            const LaneVector x = load(planes.point[d] + j);
            e += before * x * x;
        }
        m[0] += before;
        for (Index d = 0; d < dim; ++d) v[d] += before * load(planes.point[d] + j);
        for (int k = 1; k <= 2 * degree; ++k) {
            m[k] += now;
            if (k <= degree)
                for (Index d = 0; d < dim; ++d) v[k * dim + d] += now * load(planes.point[d] + j);
            const LaneVector next = twice * now - before;
            before = now;
            now = next;
        }
    }
    for (int k = 0; k <= 2 * degree; ++k) store(m[k], moments[k].value.data());
    for (Index k = 0; k < (degree + 1) * dim; ++k) store(v[k], values[k].value.data());
    store(e, energy->value.data());
}

} // namespace

BATTEN_VECTOR_CLONES
void add_span_moments(const SpanSamples& samples, int degree, double middle, double scale,
                      const double* centre, Lanes* moments, Lanes* values, Lanes* energy) {
    Planes planes;
    for (Index first = 0; first < samples.count; first += block) {
        const Index count = std::min(block, samples.count - first);
        const Index padded = (count + lanes - 1) / lanes * lanes;
        for (Index j = 0; j < count; ++j)
            planes.s[j] = (samples.parameter[first + j] - middle) * scale;
        if (samples.weight != nullptr)
            for (Index j = 0; j < count; ++j) planes.weight[j] = samples.weight[first + j];
        else
            for (Index j = 0; j < count; ++j) planes.weight[j] = 1;
        split_points_of(samples.dim, samples.point + first * samples.dim, count, centre, planes);
        for (Index j = count; j < padded; ++j) {
            planes.s[j] = planes.weight[j] = 0;
            for (Index d = 0; d < samples.dim; ++d) planes.point[d][j] = 0;
        }
        if (degree == 3 && samples.dim == 3)
            add_block<3, 3>(planes, padded, degree, samples.dim, moments, values, energy);
        else if (degree == 3 && samples.dim == 2)
            add_block<3, 2>(planes, padded, degree, samples.dim, moments, values, energy);
        else if (degree == 3 && samples.dim == 1)
            add_block<3, 1>(planes, padded, degree, samples.dim, moments, values, energy);
        else
            add_block<0, 0>(planes, padded, degree, samples.dim, moments, values, energy);
    }
}

BATTEN_VECTOR_CLONES
void add_cell_moments(const CellSamples& samples, int p, int q, Lanes* moments, Lanes* values) {
    constexpr int room = 2 * max_degree + 1;
    alignas(64) double padded_row[3][lanes];
    for (Index j = 0; j < samples.count; j += lanes) {
        const Index count = std::min<Index>(lanes, samples.count - j);
        const auto row = [&](const double* plane, int place) __attribute__((always_inline)) {
            if (count == lanes) return load(plane + j);
            for (Index k = 0; k < lanes; ++k) padded_row[place][k] = k < count ? plane[j + k] : 0;
            return load(padded_row[place]);
        };
        const LaneVector s = row(samples.s, 0);
        const LaneVector t = row(samples.t, 1);
        LaneVector ts[room];
        LaneVector tt[room];
        ts[0] = row(samples.weight, 2);
        ts[1] = ts[0] * s;
        tt[0] = s - s + 1.0;
        tt[1] = t;
        for (int k = 2; k <= 2 * p; ++k) ts[k] = (s + s) * ts[k - 1] - ts[k - 2];
        for (int k = 2; k <= 2 * q; ++k) tt[k] = (t + t) * tt[k - 1] - tt[k - 2];
        const auto add = [](Lanes & to, const LaneVector& x) __attribute__((always_inline)) {
            store(load(to.value.data()) + x, to.value.data());
        };
        for (int a = 0; a <= 2 * p; ++a)
            for (int b = 0; b <= 2 * q; ++b) add(moments[a * (2 * q + 1) + b], ts[a] * tt[b]);
        for (Index d = 0; d < samples.dim; ++d) {
            const LaneVector x = row(samples.points + d * samples.stride, 2);
            for (int a = 0; a <= p; ++a)
                for (int b = 0; b <= q; ++b)
                    add(values[(a * (q + 1) + b) * samples.dim + d], ts[a] * tt[b] * x);
        }
    }
}

} // namespace batten
