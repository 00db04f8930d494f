#include <batten/system/factored_system.hpp>

#include <batten/core/lane_vectors.hpp>
#include <batten/core/vector_clones.hpp>

namespace batten {

namespace {

constexpr Index tile_columns = 1536; // doubles of a slice that one task takes through all rows

/// Rows of one span over one tile of columns.
struct TileRows {
    const double* first;
    Index stride; ///< doubles from row to row
    Index rows;
    const double* centre;
    const double* weights; ///< (rows x terms)
    int terms;
    Index count; ///< columns
};

/// One strip of `wide` vectors through all rows, sums held in registers where their number is
/// known.
template <int known_terms, int wide>
inline __attribute__((always_inline)) void add_strip(const TileRows& tile, Index at, double* sums,
                                                     Index sums_stride, LaneVector& energy) {
    const int terms = known_terms > 0 ? known_terms : tile.terms;
    LaneVector centre[wide];
    LaneVector sum[(known_terms > 0 ? known_terms : max_degree + 1) * wide];
    for (int v = 0; v < wide; ++v) centre[v] = load(tile.centre + at + v * lanes);
    for (int r = 0; r < terms; ++r)
        for (int v = 0; v < wide; ++v)
            sum[r * wide + v] = load(sums + r * sums_stride + at + v * lanes);
    for (Index j = 0; j < tile.rows; ++j) {
        const double* row = tile.first + j * tile.stride + at;
        for (int v = 0; v < wide; ++v) {
            __builtin_prefetch(row + tile.rows * tile.stride +
                               v * lanes); // the next span's rows lie pages apart: the hardware
                                           // does not see them coming
            const LaneVector x = load(row + v * lanes) - centre[v];
            energy += x * x;
            for (int r = 0; r < terms; ++r) sum[r * wide + v] += tile.weights[j * terms + r] * x;
        }
    }
    for (int r = 0; r < terms; ++r)
        for (int v = 0; v < wide; ++v)
            store(sum[r * wide + v], sums + r * sums_stride + at + v * lanes);
}

template <int known_terms>
inline __attribute__((always_inline)) void add_strips(const TileRows& tile, double* sums,
                                                      Index sums_stride, Lanes* energy) {
    LaneVector e = load(energy->value.data());
    Index k = 0;
    for (; k + 4 * lanes <= tile.count; k += 4 * lanes)
        add_strip<known_terms, 4>(tile, k, sums, sums_stride, e);
    for (; k + lanes <= tile.count; k += lanes)
        add_strip<known_terms, 1>(tile, k, sums, sums_stride, e);
    store(e, energy->value.data());
    for (; k < tile.count; ++k)
        for (Index j = 0; j < tile.rows; ++j) {
            const double x = tile.first[j * tile.stride + k] - tile.centre[k];
            energy->value[0] += x * x;
            for (int r = 0; r < tile.terms; ++r)
                sums[r * sums_stride + k] += tile.weights[j * tile.terms + r] * x;
        }
}

/// sums[r][k] += weight[j][r] * (row_j[k] - centre[k]) over the rows j, and the squares' sum.
BATTEN_VECTOR_CLONES
void add_tile(const TileRows& tile, double* sums, Index sums_stride, Lanes* energy) {
    if (tile.terms == 4)
        add_strips<4>(tile, sums, sums_stride, energy);
    else
        add_strips<0>(tile, sums, sums_stride, energy);
}

} // namespace

KroneckerSystem::KroneckerSystem(std::vector<KnotVector> axes, std::vector<double> centre,
                                 const Parameters& parameters)
    : FactoredSystem(std::move(axes), std::move(centre)), slice_values_(dim()) {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        collocations_.emplace_back(axes_[k], parameters.axes[k]);
        for (Index j = 0; j < collocations_[k].rows(); ++j)
            grams_[k].add_outer(1, collocations_[k].row(j));
        if (k > 0) slice_values_ *= collocations_[k].rows();
    }
    slices_sum_.resize(static_cast<std::size_t>(axes_[0].free_count() * slice_values_));
    slice_centre_.resize(static_cast<std::size_t>(slice_values_));
    for (std::size_t k = 0; k < slice_centre_.size(); ++k)
        slice_centre_[k] = centre_[k % centre_.size()];
}

void KroneckerSystem::add(Index first, const Points& slices) {
    const Collocation& a = collocations_[0];
    const Index rows = slices.size() * dim() / slice_values_;
    std::vector<Lanes> energies(static_cast<std::size_t>(block_count(slice_values_, tile_columns)));
    for_each_block(slice_values_, tile_columns, [&](const Block& tile) {
        const Index begin = tile.begin;
        const Index count = tile.end - begin;
        double* sums = slices_sum_.data() + begin;
        std::vector<double> weights;
        for (Index j = 0; j < rows;) { // rows of one span share their columns
            const Index column = a.column(first + j, 0);
            const Index span_first = j;
            weights.clear();
            for (; j < rows && a.column(first + j, 0) == column; ++j)
                for (int r = 0; r <= a.degree(); ++r) weights.push_back(a.value(first + j, r));
            const TileRows group{slices.data() + span_first * slice_values_ + begin,
                                 slice_values_,
                                 j - span_first,
                                 slice_centre_.data() + begin,
                                 weights.data(),
                                 a.degree() + 1,
                                 count};
            Lanes& energy = energies[static_cast<std::size_t>(tile.index)];
            if (column + a.degree() < a.columns()) {
                add_tile(group, sums + column * slice_values_, slice_values_, &energy);
                continue;
            }
            // around the end of a closed axis the columns do not follow each other
            std::vector<double> around(static_cast<std::size_t>((a.degree() + 1) * tile_columns));
            add_tile(group, around.data(), tile_columns, &energy);
            for (int r = 0; r <= a.degree(); ++r)
                for (Index k = 0; k < count; ++k)
                    sums[a.column(span_first + first, r) * slice_values_ + k] +=
                        around[static_cast<std::size_t>(r * tile_columns + k)];
        }
    });
    for (const Lanes& energy : energies) data_energy_ += energy.sum();
    sample_count_ += slices.size();
}

void KroneckerSystem::finish() {
    std::vector<double> values = std::move(slices_sum_);
    Index inner = dim();
    for (std::size_t k = axes_.size(); k-- > 1;) {
        values = collocations_[k].apply_transposed_along(values, inner);
        inner *= axes_[k].free_count();
    }
    rhs_ = PointSet(std::move(values), dim());
}

} // namespace batten
