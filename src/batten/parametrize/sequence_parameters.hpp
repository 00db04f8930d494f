#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/samples/passes.hpp>

#include <optional>
#include <span>

namespace batten {

/// Parameters of a sequence, found chunk by chunk again in every pass rather than stored: given
/// ones, or those of parametrize_sequence to the last bit.
class SequenceParameters {
  public:
    /// Given parameters, which must outlive this.
    explicit SequenceParameters(std::span<const double> given) : given_(given) {}
    SequenceParameters(Parametrization rule, Closure closure, Index dim)
        : rule_(rule), closure_(closure), dim_(dim) {}

    /// Whether they follow from the lengths of the steps between the samples.
    bool by_length() const { return rule_ && *rule_ != Parametrization::uniform; }

    /// Before the first pass, where they are given: checks them (InvalidInput).
    void check_given() const;
    const std::span<const double>& given() const { return given_; }

    /// First pass, of every chunk: the lengths of its steps, accumulated in `room`, where
    /// parameters follow from them.
    std::span<const double> begin(const SampleChunk& chunk, std::vector<double>& room) const;
    /// First pass, in order, with what that answered.
    void add(const SampleChunk& chunk, std::span<const double> lengths);
    /// Length of the way before the chunk that was added last.
    double way() const { return offsets_.back(); }
    /// Once the number of samples is known, and the lengths where they count. Throws InvalidInput
    /// where all points are identical, or fewer or more than the given parameters.
    void finish(Index samples);

    /// Length of the whole way, by which others are divided.
    double whole() const { return total_; }
    double front() const { return given_.empty() ? 0 : given_.front(); }
    double back() const;
    /// Parameter of a sample where they do not follow from lengths.
    double of(Index sample) const;

    /// Later passes: the chunk's parameters, in `room` where they are not given.
    std::span<const double> of(const SampleChunk& chunk, std::vector<double>& room) const;

  private:
    std::span<const double> given_{};
    std::optional<Parametrization> rule_{};
    Closure closure_ = Closure::open;
    Index dim_ = 0;
    Index samples_ = 0;
    std::vector<double> first_{};   ///< sample
    std::vector<double> last_{};    ///< sample so far
    std::vector<double> offsets_{}; ///< way before each chunk
    double way_ = 0;                ///< so far
    double total_ = 0;
};

} // namespace batten
