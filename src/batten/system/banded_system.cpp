#include <batten/system/factored_system.hpp>

#include <batten/system/chebyshev_maps.hpp>
#include <batten/system/moments.hpp>

#include <algorithm>
#include <cassert>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr Index chunk_samples = 1 << 14;
constexpr Index wave_chunks = 16; // chunks under way at once: bounds the memory of their results

constexpr Index few_samples = 4; // per B-spline: below, a span's moments cost more than they save

/// What the samples of one chunk add to the spans that they touch.
struct ChunkSums {
    std::vector<Index> spans;
    std::vector<double> grams; ///< per span the pairs (i, j), i <= j
    std::vector<double> rhs;   ///< per span (p + 1) x dim
    double energy = 0;
};

/// The samples of a chunk, span by span.
class ChunkPass {
  public:
    ChunkPass(const KnotVector& knots, const std::vector<double>& centre)
        : knots_(knots), centre_(centre), dim_(static_cast<Index>(centre.size())) {}

    ChunkSums operator()(const double* t, const double* q, const double* w, Index count) const {
        ChunkSums sums;
        Lanes energy;
        const int p = knots_.degree();
        Room room{std::vector<Lanes>(static_cast<std::size_t>(2 * p + 1)),
                  std::vector<Lanes>(static_cast<std::size_t>((p + 1) * dim_))};
        for (Index i = 0; i < count;) {
            const double inside = knots_.wrapped(t[i]);
            if (!knots_.contains(inside))
                throw outside_domain(knots_, fmt::format("parameter {}", t[i]));
            const double shift = t[i] - inside; // whole periods of a closed axis
            const Index span = knots_.span(inside);
            const bool last = knots_[span + 1] == knots_.end() && !knots_.closed();
            const double limit = knots_[span + 1] + shift;
            Index end = std::lower_bound(t + i, t + count, limit) - t;
            if (last) end = std::upper_bound(t + i, t + count, limit) - t;
            end = std::max(end, i + 1);
            const SpanSamples samples{t + i, q + i * dim_, w == nullptr ? nullptr : w + i, end - i,
                                      dim_};
            if (samples.count < few_samples * (p + 1))
                add_few(span, shift, samples, energy, sums);
            else
                add_span(span, shift, samples, energy, room, sums);
            i = end;
        }
        sums.energy = energy.sum();
        return sums;
    }

  private:
    /// Memory of one chunk's pass, used span after span.
    struct Room {
        std::vector<Lanes> moments;
        std::vector<Lanes> values;
    };

    /// Of a span with few samples: sample by sample.
    void add_few(Index span, double shift, const SpanSamples& samples, Lanes& energy,
                 ChunkSums& sums) const {
        const int p = knots_.degree();
        sums.spans.push_back(span);
        const std::size_t gram = sums.grams.size();
        const std::size_t at = sums.rhs.size();
        sums.grams.resize(gram + static_cast<std::size_t>((p + 1) * (p + 2) / 2));
        sums.rhs.resize(at + static_cast<std::size_t>((p + 1) * dim_));
        for (Index s = 0; s < samples.count; ++s) {
            const BasisValues b = basis_values(knots_, span, samples.parameter[s] - shift);
            const double weight = samples.weight == nullptr ? 1 : samples.weight[s];
            double* pair = sums.grams.data() + gram;
            for (int i = 0; i <= p; ++i)
                for (int j = i; j <= p; ++j)
                    *pair++ +=
                        weight * b[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(j)];
            const double* point = samples.point + s * dim_;
            for (Index d = 0; d < dim_; ++d) {
                const double value = point[d] - centre_[static_cast<std::size_t>(d)];
                energy.value[static_cast<std::size_t>(s % lanes)] += weight * value * value;
                for (int i = 0; i <= p; ++i)
                    sums.rhs[at + static_cast<std::size_t>(i * dim_ + d)] +=
                        weight * value * b[static_cast<std::size_t>(i)];
            }
        }
    }

    void add_span(Index span, double shift, const SpanSamples& samples, Lanes& energy, Room& room,
                  ChunkSums& sums) const {
        const int p = knots_.degree();
        const ChebyshevMaps maps(knots_, span);
        std::vector<Lanes>& moments = room.moments;
        std::vector<Lanes>& values = room.values;
        std::fill(moments.begin(), moments.end(), Lanes{});
        std::fill(values.begin(), values.end(), Lanes{});
        add_span_moments(samples, p, maps.middle() + shift, maps.scale(), centre_.data(),
                         moments.data(), values.data(), &energy);
        std::array<double, 2 * max_degree + 1> moment{};
        for (int k = 0; k <= 2 * p; ++k)
            moment[static_cast<std::size_t>(k)] = moments[static_cast<std::size_t>(k)].sum();
        sums.spans.push_back(span);
        for (int i = 0; i <= p; ++i)
            for (int j = i; j <= p; ++j) sums.grams.push_back(maps.pair(i, j, moment.data()));
        const std::size_t at = sums.rhs.size();
        sums.rhs.resize(at + static_cast<std::size_t>((p + 1) * dim_));
        for (int k = 0; k <= p; ++k)
            for (Index d = 0; d < dim_; ++d) {
                const double value = values[static_cast<std::size_t>(k * dim_ + d)].sum();
                for (int i = 0; i <= p; ++i)
                    sums.rhs[at + static_cast<std::size_t>(i * dim_ + d)] +=
                        maps.coefficients(i)[k] * value;
            }
    }

    const KnotVector& knots_;
    const std::vector<double>& centre_;
    Index dim_;
};

} // namespace

BandedSystem::BandedSystem(const KnotVector& knots, std::vector<double> centre)
    : FactoredSystem({knots}, std::move(centre)) {}

void BandedSystem::add(std::span<const double> parameters, const Points& points,
                       std::span<const double> weights) {
    assert(static_cast<Index>(parameters.size()) == points.size());
    const KnotVector& knots = axes_[0];
    const int p = knots.degree();
    const Index n = knots.free_count();
    const ChunkPass pass(knots, centre_);
    BandedMatrix& gram = grams_[0];
    const Index chunks = block_count(points.size(), chunk_samples);
    std::vector<ChunkSums> wave;
    for (Index first = 0; first < chunks; first += wave_chunks) {
        const Index count = std::min(wave_chunks, chunks - first);
        wave.assign(static_cast<std::size_t>(count), {});
        for_each_chunk(count, [&](Index k) {
            const Index begin = (first + k) * chunk_samples;
            const Index size = std::min(chunk_samples, points.size() - begin);
            wave[static_cast<std::size_t>(k)] =
                pass(parameters.data() + begin, points.data() + begin * dim(),
                     weights.empty() ? nullptr : weights.data() + begin, size);
        });
        for (const ChunkSums& sums : wave) { // in order: the same bits for any number of threads
            std::size_t pair = 0;
            std::size_t value = 0;
            for (Index span : sums.spans) {
                for (int i = 0; i <= p; ++i) {
                    const Index row = (span - p + i) % n;
                    for (int j = i; j <= p; ++j) gram.at(row, j - i) += sums.grams[pair++];
                    for (Index d = 0; d < dim(); ++d) rhs_(row, d) += sums.rhs[value++];
                }
            }
            data_energy_ += sums.energy;
        }
    }
    sample_count_ += points.size();
}

} // namespace batten
