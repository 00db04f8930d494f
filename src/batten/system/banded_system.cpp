#include <batten/system/factored_system.hpp>

#include <batten/samples/passes.hpp>
#include <batten/system/chebyshev_maps.hpp>
#include <batten/system/moments.hpp>

#include <algorithm>
#include <cassert>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr Index wave_chunks = 16; // chunks under way at once: bounds the memory of their results

constexpr Index few_samples = 4; // per B-spline: below, a span's moments cost more than they save

/// The samples of a chunk, span by span.
class ChunkPass {
  public:
    ChunkPass(const KnotVector& knots, const std::vector<double>& centre)
        : knots_(knots), centre_(centre), dim_(static_cast<Index>(centre.size())) {}

    void operator()(const double* t, const double* q, const double* w, Index count,
                    SpanSums& sums) const {
        for (std::vector<double>* of : {&sums.grams, &sums.rhs, &sums.telling}) of->clear();
        sums.spans.clear();
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
            add_telling(t + i, t + end, sums.telling);
            i = end;
        }
        sums.energy = energy.sum();
        sums.samples = count;
    }

  private:
    /// Memory of one chunk's pass, used span after span.
    struct Room {
        std::vector<Lanes> moments;
        std::vector<Lanes> values;
    };

    /// Of a span's parameters those that tell what they determine: one at the knot and as many
    /// others as there are B-splines, and the last.
    void add_telling(const double* begin, const double* end, std::vector<double>& telling) const {
        const double last = *(end - 1);
        for (int k = 0; k <= knots_.degree() + 1 && begin != end; ++k) {
            telling.push_back(*begin);
            ++begin;
            if (begin != end && *begin == telling.back())
                begin = std::upper_bound(begin, end, telling.back());
        }
        if (telling.back() != last) telling.push_back(last);
    }

    /// Of a span with few samples: sample by sample.
    void add_few(Index span, double shift, const SpanSamples& samples, Lanes& energy,
                 SpanSums& sums) const {
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
                  SpanSums& sums) const {
        const int p = knots_.degree();
        const ChebyshevPairs maps(knots_, span);
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
    const Index chunks = block_count(points.size(), chunk_samples);
    std::vector<SpanSums> wave(static_cast<std::size_t>(std::min(chunks, wave_chunks)));
    for (Index first = 0; first < chunks; first += wave_chunks) {
        const Index count = std::min(wave_chunks, chunks - first);
        for_each_chunk(count, [&](Index k) {
            const Index begin = (first + k) * chunk_samples;
            const Index size = std::min(chunk_samples, points.size() - begin);
            sum(parameters.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(size)),
                points.data() + begin * dim(), weights.empty() ? nullptr : weights.data() + begin,
                wave[static_cast<std::size_t>(k)]);
        });
        for (Index k = 0; k < count; ++k) // in order: the same bits for any number of threads
            add(wave[static_cast<std::size_t>(k)]);
    }
}

void BandedSystem::sum(std::span<const double> parameters, const double* points,
                       const double* weights, SpanSums& sums) const {
    ChunkPass(axes_[0], centre_)(parameters.data(), points, weights,
                                 static_cast<Index>(parameters.size()), sums);
}

void BandedSystem::add(const SpanSums& sums) {
    const int p = axes_[0].degree();
    const Index n = axes_[0].free_count();
    std::size_t pair = 0;
    std::size_t value = 0;
    for (Index span : sums.spans) {
        for (int i = 0; i <= p; ++i) {
            const Index row = (span - p + i) % n;
            for (int j = i; j <= p; ++j) grams_[0].at(row, j - i) += sums.grams[pair++];
            for (Index d = 0; d < dim(); ++d) rhs_(row, d) += sums.rhs[value++];
        }
    }
    data_energy_ += sums.energy;
    sample_count_ += sums.samples;
}

} // namespace batten
