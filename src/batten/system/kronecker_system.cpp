#include <batten/system/factored_system.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/system/moments.hpp>

#include <algorithm>

namespace batten {

namespace {

constexpr Index tile = 1024; // doubles of a slice that one task takes through all rows

void add_gram_row(BandedMatrix& gram, const Collocation& a, Index j) {
    for (int r = 0; r <= a.degree(); ++r)
        for (int s = r; s <= a.degree(); ++s)
            gram.at(a.column(j, r), s - r) += a.value(j, r) * a.value(j, s);
}

typedef double Vector __attribute__((
    vector_size(64))); // NOLINT(modernize-use-using): GCC wants the attribute on a typedef

inline __attribute__((always_inline)) Vector load(const double* x) {
    Vector v;
    __builtin_memcpy(&v, x, sizeof v);
    return v;
}

template <int known_terms>
inline __attribute__((always_inline)) void
add_row(const double* row, const double* next, const double* centre, const double* weight,
        int terms_, Index count, double* sums, Lanes* energy) {
    const int terms = known_terms > 0 ? known_terms : terms_;
    Vector e = load(energy->value.data());
    Index k = 0;
    for (; k + lanes <= count; k += lanes) {
        __builtin_prefetch(
            next + k); // rows lie pages apart: the hardware does not see the next one coming
        const Vector x = load(row + k) - load(centre + k);
        e += x * x;
        for (int r = 0; r < terms; ++r) {
            const Vector sum = load(sums + r * tile + k) + weight[r] * x;
            __builtin_memcpy(sums + r * tile + k, &sum, sizeof sum);
        }
    }
    __builtin_memcpy(energy->value.data(), &e, sizeof e);
    for (; k < count; ++k) {
        const double x = row[k] - centre[k];
        energy->value[0] += x * x;
        for (int r = 0; r < terms; ++r) sums[r * tile + k] += weight[r] * x;
    }
}

/// sums[r][k] += weight[r] * (row[k] - centre[k]) and the squares' sum, over one tile of one row.
BATTEN_VECTOR_CLONES
void add_tile(const double* row, const double* next, const double* centre, const double* weight,
              int terms, Index count, double* sums, Lanes* energy) {
    if (terms == 4)
        add_row<4>(row, next, centre, weight, terms, count, sums, energy);
    else
        add_row<0>(row, next, centre, weight, terms, count, sums, energy);
}

} // namespace

KroneckerSystem::KroneckerSystem(std::vector<KnotVector> axes, std::vector<double> centre,
                                 const Parameters& parameters)
    : NormalSystem(std::move(axes), std::move(centre)), slice_values_(dim()) {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        collocations_.emplace_back(axes_[k], parameters.axes[k]);
        grams_.emplace_back(axes_[k].free_count(), axes_[k].degree(), axes_[k].closure());
        for (Index j = 0; j < collocations_[k].rows(); ++j)
            add_gram_row(grams_[k], collocations_[k], j);
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
    const Index tiles = (slice_values_ + tile - 1) / tile;
    std::vector<Lanes> energies(static_cast<std::size_t>(tiles));
    for_each_chunk(tiles, [&](Index t) {
        const Index begin = t * tile;
        const Index count = std::min(tile, slice_values_ - begin);
        alignas(64) double sums[(max_degree + 1) * tile];
        for (Index j = 0; j < rows;) { // rows of one span share their columns
            const Index column = a.column(first + j, 0);
            std::fill_n(sums, (a.degree() + 1) * tile, 0.0);
            for (; j < rows && a.column(first + j, 0) == column; ++j) {
                double weight[max_degree + 1];
                for (int r = 0; r <= a.degree(); ++r) weight[r] = a.value(first + j, r);
                const double* row = slices.data() + j * slice_values_ + begin;
                add_tile(row, j + 1 < rows ? row + slice_values_ : row,
                         slice_centre_.data() + begin, weight, a.degree() + 1, count, sums,
                         &energies[static_cast<std::size_t>(t)]);
            }
            for (int r = 0; r <= a.degree(); ++r) {
                double* to =
                    slices_sum_.data() + a.column(first + j - 1, r) * slice_values_ + begin;
                for (Index k = 0; k < count; ++k) to[k] += sums[r * tile + k];
            }
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

void KroneckerSystem::apply(const PointSet& x, PointSet& y) const {
    PointSet scratch;
    const PointSet* from = &x;
    Index inner = x.dim();
    for (std::size_t k = axes_.size(); k-- > 0;) {
        const Index n = axes_[k].free_count();
        const AxisLayout layout{static_cast<Index>(x.values().size()) / (n * inner), inner};
        if (k + 1 < axes_.size()) scratch = *from;
        grams_[k].apply(k + 1 < axes_.size() ? scratch.data() : from->data(), y.data(), layout);
        from = &y;
        inner *= n;
    }
}

std::vector<double> KroneckerSystem::diagonal() const {
    std::vector<double> result{1.0};
    for (const BandedMatrix& gram : grams_) {
        std::vector<double> next;
        for (double outer : result)
            for (double inner : gram.diagonal()) next.push_back(outer * inner);
        result = std::move(next);
    }
    return result;
}

std::vector<const BandedMatrix*> KroneckerSystem::factors() const {
    std::vector<const BandedMatrix*> result;
    for (const BandedMatrix& gram : grams_) result.push_back(&gram);
    return result;
}

} // namespace batten
