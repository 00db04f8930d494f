#include <batten/samples/passes.hpp>

#include <batten/core/stopwatch.hpp>

#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

/// As many places as keep the threads busy; no more than there are chunks.
std::size_t places_for(Index samples) {
    const Index wanted = thread_count() == 1 ? 1 : 2 * thread_count();
    if (samples < 0) return static_cast<std::size_t>(wanted);
    return static_cast<std::size_t>(
        std::clamp<Index>(block_count(samples, chunk_samples), 1, wanted));
}

} // namespace

SamplePasses::SamplePasses(SampleSource& source, const std::function<bool()>& cancelled)
    : source_(source),
      cancelled_(cancelled),
      places_(places_for(source.size())),
      samples_(source.size()),
      bytes_before_(source.bytes()) {}

/// The next chunks, whole ones but at the end.
Points SamplePasses::wave() {
    const Index wanted = static_cast<Index>(places_) * chunk_samples;
    const Points points = source_.next(wanted);
    weights_ = source_.weights();
    const bool last = samples_ >= 0 && taken_ + points.size() >= samples_;
    if (points.empty() || points.size() >= wanted || last) return points;
    return gathered(points, wanted);
}

Points SamplePasses::gathered(Points first, Index wanted) {
    const Index dim = source_.dim();
    if (buffer_.empty()) buffer_ = PointSet(wanted, dim);
    buffered_weights_.clear();
    Index have = 0;
    for (Points more = std::move(first); !more.empty(); more = source_.next(wanted - have)) {
        std::copy_n(more.data(), more.size() * dim, buffer_.data() + have * dim);
        const std::span<const double> own = source_.weights();
        buffered_weights_.insert(buffered_weights_.end(), own.begin(), own.end());
        have += more.size();
        if (have == wanted) break;
    }
    weights_ = buffered_weights_;
    return Points(buffer_).slice(0, have);
}

void SamplePasses::run(Work work, Work merge, FunctionRef<void(const SampleChunk& first)> start) {
    const auto dim = static_cast<std::size_t>(source_.dim());
    std::vector<double> before;
    Stopwatch watch;
    source_.rewind();
    taken_ = 0;
    for (;;) {
        if (cancelled_ && cancelled_()) throw Cancelled("the fit was cancelled");
        watch.lap();
        const Points points = wave();
        reading_ += watch.lap();
        if (points.empty()) break;
        if (!weights_.empty() && static_cast<Index>(weights_.size()) != points.size())
            throw InvalidInput(fmt::format("weights: {} given for {} samples; one per sample is "
                                           "needed",
                                           weights_.size(), points.size()));
        const auto chunk = [&](Index k) {
            const Index begin = k * chunk_samples;
            const double* data = points.data() + begin * points.dim();
            return SampleChunk{taken_ + begin, std::min(chunk_samples, points.size() - begin), data,
                               weights_.empty() ? nullptr : weights_.data() + begin,
                               k > 0            ? data - points.dim()
                               : before.empty() ? nullptr
                                                : before.data()};
        };
        if (taken_ == 0) start(chunk(0));
        const Index chunks = block_count(points.size(), chunk_samples);
        for_each_chunk(chunks, [&](Index k) { work(chunk(k), static_cast<std::size_t>(k)); });
        for (Index k = 0; k < chunks; ++k) merge(chunk(k), static_cast<std::size_t>(k));
        const auto last = points[points.size() - 1];
        before.assign(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(dim));
        taken_ += points.size();
    }
    if (samples_ >= 0 && taken_ != samples_)
        throw InvalidInput(fmt::format("samples: {} were there before, {} came", samples_, taken_));
    samples_ = taken_;
    ++count_;
}

double SamplePasses::reading_lap() {
    return std::exchange(reading_, 0);
}

} // namespace batten
