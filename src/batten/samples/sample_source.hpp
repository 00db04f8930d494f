#pragma once

#include <batten/samples/samples.hpp>

#include <algorithm>
#include <span>

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
    virtual Spacing spacing() const { return Spacing::free; }
    /// What was done to the data on the way in, one sentence each.
    virtual std::vector<std::string> notes() const { return {}; }
    /// Bytes read from a file in all passes so far; 0 of what is in memory.
    virtual Index bytes() const { return 0; }

    /// Back to the first sample.
    virtual void rewind() = 0;
    /// The next samples (1 to `most` of them), none at the end; they stay until the next call.
    /// Throws FileError where a file cannot be read on or is another than in the pass before.
    virtual Points next(Index most) = 0;
    /// One positive weight for each of the samples that next() gave last; empty: all are one.
    virtual std::span<const double> weights() const { return {}; }

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
    Spacing spacing() const override { return samples_.spacing; }
    std::vector<std::string> notes() const override { return samples_.notes; }
    void rewind() override { first_ = next_ = 0; }
    Points next(Index most) override {
        first_ = next_;
        next_ += std::min(most, samples_.size() - first_);
        return samples_.points.slice(first_, next_ - first_);
    }
    std::span<const double> weights() const override {
        if (samples_.weights.empty()) return {};
        return std::span(samples_.weights)
            .subspan(static_cast<std::size_t>(first_), static_cast<std::size_t>(next_ - first_));
    }

  private:
    const Samples& samples_;
    Index first_ = 0;
    Index next_ = 0;
};

} // namespace batten
