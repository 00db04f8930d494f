#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/samples/sample_source.hpp>

#include <functional>

namespace batten {

/// Samples that passes take at once: the same places whatever chunks a source gives, so that sums
/// over them have the same bits.
inline constexpr Index chunk_samples = 1 << 14;

/// Some samples on their way through a pass.
struct SampleChunk {
    Index first = 0; ///< samples before them
    Index count = 0;
    const double* points = nullptr;  ///< (count x dim)
    const double* weights = nullptr; ///< (count), or null: all are one
    const double* before = nullptr;  ///< the sample before the first, null where there is none
    Index index() const { return first / chunk_samples; }
};

/// Passes over the samples of a source, several chunks at a time; nothing is kept of them.
class SamplePasses {
  public:
    /// With the chunk the number of its place among those taken at the same time.
    using Work = FunctionRef<void(const SampleChunk& chunk, std::size_t place)>;

    /// Cancelled is thrown when `cancelled` says so.
    SamplePasses(SampleSource& source, const std::function<bool()>& cancelled);

    /// Chunks that are taken at the same time at most: places to work in.
    std::size_t places() const { return places_; }

    /// One pass: `work` for every chunk, on all threads, then `merge` for each in order; `start`
    /// before them, with the first chunk. Throws InvalidInput where it has not as many samples as
    /// the source or the pass before told.
    void run(Work work, Work merge, FunctionRef<void(const SampleChunk& first)> start);
    void run(Work work, Work merge) {
        run(work, merge, [](const SampleChunk&) {});
    }

    Index dim() const { return source_.dim(); }
    Index samples() const { return samples_; } ///< -1: not known before the first pass
    Index count() const { return count_; }     ///< passes so far
    /// Bytes that the source read in them.
    Index bytes() const { return source_.bytes() - bytes_before_; }
    /// Seconds that the source took since this was asked last.
    double reading_lap();

  private:
    Points wave();
    Points gathered(Points first, Index wanted);

    SampleSource& source_;
    const std::function<bool()>& cancelled_;
    std::size_t places_;
    Index samples_;
    Index bytes_before_;
    Index count_ = 0;
    Index taken_ = 0; // of this pass
    double reading_ = 0;
    PointSet buffer_; // where a source gives less at a time
    std::vector<double> buffered_weights_;
    std::span<const double> weights_; // of the wave
};

} // namespace batten
