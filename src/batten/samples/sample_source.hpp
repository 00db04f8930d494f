#pragma once

#include <batten/samples/samples.hpp>

#include <algorithm>

namespace batten {

/// Samples that are read in chunks, from the first to the last, as often as needed: an array in
/// memory, a file, a caller's own. Passes over one need memory for a chunk, not for the samples.
class SampleSource {
  public:
    virtual ~SampleSource() = default;
    SampleSource(const SampleSource&) = delete;
    SampleSource& operator=(const SampleSource&) = delete;

    /// Coordinates of a sample, 1 to 16.
    virtual Index dim() const = 0;
    /// Number of samples; -1 where a file does not say and no pass has come to its end yet.
    virtual Index size() const = 0;
    /// Samples per axis of a grid, row-major; empty for a sequence or a cloud.
    virtual std::vector<Index> grid() const { return {}; }
    virtual Order order() const { return Order::along_curve; }

    /// Back to the first sample.
    virtual void rewind() = 0;
    /// The next samples (1 to `most` of them), none at the end; they stay until the next call.
    /// Throws FileError where a file cannot be read on or is another than in the pass before.
    virtual Points next(Index most) = 0;

  protected:
    SampleSource() = default;
};

/// Samples in memory, which must outlive it: chunks are views, nothing is copied.
class MemorySource final : public SampleSource {
  public:
    explicit MemorySource(const Samples& samples) : samples_(samples) {}

    Index dim() const override { return samples_.dim(); }
    Index size() const override { return samples_.size(); }
    std::vector<Index> grid() const override { return samples_.grid; }
    Order order() const override { return samples_.order; }
    void rewind() override { next_ = 0; }
    Points next(Index most) override {
        const Index first = next_;
        next_ += std::min(most, samples_.size() - first);
        return samples_.points.slice(first, next_ - first);
    }

  private:
    const Samples& samples_;
    Index next_ = 0;
};

} // namespace batten
