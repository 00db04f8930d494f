#include <batten/measure/grid_deviation.hpp>

#include <batten/basis/active_functions.hpp>
#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>
#include <batten/core/vectors.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index tile_values = 1536; // coordinates of a slice that one task takes through all slices

using Axis = std::vector<ActiveFunctions>;

Axis axis_of(const KnotVector& knots, const std::vector<double>& parameters) {
    Axis axis;
    for (double t : parameters) axis.push_back(active_functions(knots, t, Numbering::stored));
    return axis;
}

/// One slice's part of a tile.
struct TileRow {
    const double* rows;   ///< of the spline, first active one
    Index stride;         ///< from row to row
    const double* values; ///< of the active functions
    int terms;
    const double* points;
    const double* centre;
    Index count; ///< coordinates
    Index dim;
};

template <int known_terms>
inline __attribute__((always_inline)) void squares_of(const TileRow& row, double* squares) {
    const int terms = known_terms > 0 ? known_terms : row.terms;
    Index k = 0;
    for (; k + lanes <= row.count; k += lanes) {
        LaneVector gap = load(row.centre + k) - load(row.points + k);
        for (int r = 0; r < terms; ++r) gap += row.values[r] * load(row.rows + r * row.stride + k);
        store(gap * gap, squares + k);
    }
    for (; k < row.count; ++k) {
        double gap = row.centre[k] - row.points[k];
        for (int r = 0; r < terms; ++r) gap += row.values[r] * row.rows[r * row.stride + k];
        squares[k] = gap * gap;
    }
}

template <int known_dim>
inline __attribute__((always_inline)) void sums_of(const double* squares, Index samples, Index dim_,
                                                   double* out) {
    const Index dim = known_dim > 0 ? known_dim : dim_;
    for (Index i = 0; i < samples; ++i) {
        double sum = squares[i * dim];
        for (Index d = 1; d < dim; ++d) sum += squares[i * dim + d];
        out[i] = sum;
    }
}

/// Squared distances of a row's samples; `squares` has room for their coordinates'.
BATTEN_VECTOR_CLONES
void squared_distances(const TileRow& row, double* squares, double* out) {
    if (row.terms == 4)
        squares_of<4>(row, squares);
    else
        squares_of<0>(row, squares);
    const Index samples = row.count / row.dim;
    if (row.dim == 1)
        sums_of<1>(squares, samples, 1, out);
    else if (row.dim == 3)
        sums_of<3>(squares, samples, 3, out);
    else
        sums_of<0>(squares, samples, row.dim, out);
}

/// Adds to the lanes' sums and largest of `count` numbers, a multiple of the lanes.
BATTEN_VECTOR_CLONES
void add_up(const double* x, Index count, Lanes* sums, Lanes* largest) {
    LaneVector sum = load(sums->value.data());
    LaneVector most = load(largest->value.data());
    for (Index k = 0; k < count; k += lanes) {
        const LaneVector v = load(x + k);
        sum += v;
        most = v > most ? v : most;
    }
    store(sum, sums->value.data());
    store(most, largest->value.data());
}

BATTEN_VECTOR_CLONES
void take_roots(const double* x, Index count, double* out) {
    for (Index i = 0; i < count; ++i) out[i] = std::sqrt(x[i]);
}

/// What a tile came to.
struct TileDeviation {
    double squares = 0;
    double largest = -1; ///< squared
    Index worst = 0;
};

/// Control points relative to the first one, contracted along all axes but the first two:
/// (n_0 x n_1 x inner).
std::vector<double> inner_values(const Spline& spline,
                                 const std::vector<std::vector<double>>& axes) {
    const Index dim = spline.dim();
    std::vector<double> values = spline.control_points().values();
    const std::vector<double> centre(values.begin(), values.begin() + dim);
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] -= centre[k % static_cast<std::size_t>(dim)];
    if (axes.size() == 2) return values;
    const Axis last = axis_of(spline.axis(2), axes[2]);
    const Index n = spline.axis(2).control_count();
    const auto m = static_cast<Index>(last.size());
    const Index outer = static_cast<Index>(values.size()) / (n * dim);
    std::vector<double> result(static_cast<std::size_t>(outer * m * dim));
    for_each_chunk(outer, [&](Index o) {
        for (Index j = 0; j < m; ++j) {
            const ActiveFunctions& here = last[static_cast<std::size_t>(j)];
            for (int r = 0; r <= here.degree; ++r)
                add_scaled(result.data() + (o * m + j) * dim,
                           here.value[static_cast<std::size_t>(r)],
                           values.data() + (o * n + here.index(r)) * dim, dim);
        }
    });
    return result;
}

/// What all tiles share.
struct Grid {
    const Spline& spline;
    const Points& points;
    Axis first;
    Axis second;
    std::vector<double> values; ///< of the spline, (n x columns x inner)
    Index n;
    Index columns;
    Index inner;
    double* each;
};

/// The spline over axis 1's parameters from `begin` to before `end`: (n x count).
std::vector<double> lines_of(const Grid& grid, Index begin, Index end) {
    const Index count = (end - begin) * grid.inner;
    std::vector<double> lines(static_cast<std::size_t>(grid.n * count));
    for (Index i = 0; i < grid.n; ++i)
        for (Index j = begin; j < end; ++j) {
            const ActiveFunctions& here = grid.second[static_cast<std::size_t>(j)];
            double* line = lines.data() + i * count + (j - begin) * grid.inner;
            for (int r = 0; r <= here.degree; ++r)
                add_scaled(line, here.value[static_cast<std::size_t>(r)],
                           grid.values.data() + (i * grid.columns + here.index(r)) * grid.inner,
                           grid.inner);
        }
    return lines;
}

TileDeviation deviation_of_tile(const Grid& grid, const Block& tile) {
    const Index dim = grid.points.dim();
    const Index slice = static_cast<Index>(grid.second.size()) * grid.inner;
    const Index count = (tile.end - tile.begin) * grid.inner;
    const Index samples = count / dim;
    const std::vector<double> lines = lines_of(grid, tile.begin, tile.end);
    std::vector<double> centre(static_cast<std::size_t>(count));
    for (Index k = 0; k < count; ++k)
        centre[static_cast<std::size_t>(k)] = grid.spline.control_points()(0, k % dim);
    std::vector<double> squares(static_cast<std::size_t>(count));
    std::vector<double> distances(static_cast<std::size_t>((samples + lanes - 1) / lanes * lanes));
    TileDeviation result;
    Lanes sums;
    for (std::size_t j = 0; j < grid.first.size(); ++j) {
        const ActiveFunctions& here = grid.first[j];
        const Index at = static_cast<Index>(j) * slice + tile.begin * grid.inner;
        squared_distances({lines.data() + here.first * count, count, here.value.data(),
                           here.degree + 1, grid.points.data() + at, centre.data(), count, dim},
                          squares.data(), distances.data());
        Lanes largest;
        add_up(distances.data(), static_cast<Index>(distances.size()), &sums, &largest);
        const double most = *std::ranges::max_element(largest.value);
        if (most > result.largest) {
            result.largest = most;
            result.worst = at / dim + (std::ranges::find(distances, most) - distances.begin());
        }
        if (grid.each != nullptr) take_roots(distances.data(), samples, grid.each + at / dim);
    }
    result.squares = sums.sum();
    return result;
}

} // namespace

Deviation grid_deviation(const Spline& spline, const Points& points,
                         const std::vector<std::vector<double>>& axes, double* each) {
    const Index n = spline.axis(0).control_count();
    const Index columns = spline.axis(1).control_count();
    std::vector<double> values = inner_values(spline, axes);
    const Index inner = static_cast<Index>(values.size()) / (n * columns);
    const Grid grid{spline,
                    points,
                    axis_of(spline.axis(0), axes[0]),
                    axis_of(spline.axis(1), axes[1]),
                    std::move(values),
                    n,
                    columns,
                    inner,
                    each};
    const auto rows = static_cast<Index>(axes[1].size());
    const Index wide = std::max<Index>(1, tile_values / inner);
    std::vector<TileDeviation> tiles(static_cast<std::size_t>(block_count(rows, wide)));
    for_each_block(rows, wide, [&](const Block& tile) {
        tiles[static_cast<std::size_t>(tile.index)] = deviation_of_tile(grid, tile);
    });
    TileDeviation whole;
    for (const TileDeviation& tile : tiles) {
        whole.squares += tile.squares;
        if (tile.largest > whole.largest ||
            (tile.largest == whole.largest && tile.worst < whole.worst)) {
            whole.largest = tile.largest;
            whole.worst = tile.worst;
        }
    }
    return {.maximum = std::sqrt(std::max(0.0, whole.largest)),
            .rms = std::sqrt(whole.squares / static_cast<double>(points.size())),
            .worst_sample = whole.worst,
            .kind = DeviationKind::parametric};
}

} // namespace batten
