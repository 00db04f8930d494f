#include <batten/parametrize/sequence_parameters.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/parametrize/step_lengths.hpp>

#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

BATTEN_VECTOR_CLONES
void normalise(double* t, Index count, double offset, double total) {
    for (Index i = 0; i < count; ++i) t[i] = (offset + t[i]) / total;
}

BATTEN_VECTOR_CLONES
void number(double* t, int count, double first, double steps) {
    for (int i = 0; i < count; ++i) t[i] = (first + static_cast<double>(i)) / steps;
}

double steps_of(Index samples, Closure closure) {
    return static_cast<double>(closure == Closure::closed ? samples : samples - 1);
}

} // namespace

void SequenceParameters::check_given() const {
    if (given_.empty()) return;
    const auto count = static_cast<Index>(given_.size());
    check_ascending(given_, 0, count, 0);
    check_range(given_, 0);
}

std::span<const double> SequenceParameters::begin(const SampleChunk& chunk,
                                                  std::vector<double>& room) const {
    if (!by_length()) return {};
    const auto count = static_cast<std::size_t>(chunk.count);
    if (room.size() < count) room.resize(count);
    accumulate_steps(chunk.points, chunk.count, dim_, chunk.before, *rule_, room.data());
    return {room.data(), count};
}

void SequenceParameters::add(const SampleChunk& chunk, std::span<const double> lengths) {
    if (!by_length()) return;
    const double* end = chunk.points + chunk.count * dim_;
    if (chunk.first == 0) first_.assign(chunk.points, chunk.points + dim_);
    last_.assign(end - dim_, end);
    offsets_.push_back(way_);
    way_ += lengths.back();
}

void SequenceParameters::finish(Index samples) {
    samples_ = samples;
    if (!rule_) {
        check_parameter_count(static_cast<Index>(given_.size()), samples, 0);
        return;
    }
    check_strand(samples, 0);
    if (!by_length()) return;
    total_ = way_;
    if (closure_ == Closure::closed) {
        const double length = distance(last_, first_);
        total_ += *rule_ == Parametrization::centripetal ? std::sqrt(length) : length;
    }
    if (!(total_ > 0)) throw no_length(0);
}

double SequenceParameters::back() const {
    if (!rule_) return given_.back();
    if (closure_ == Closure::open) return 1;
    return by_length() ? way_ / total_ : of(samples_ - 1);
}

double SequenceParameters::of(Index sample) const {
    return rule_ ? static_cast<double>(sample) / steps_of(samples_, closure_)
                 : given_[static_cast<std::size_t>(sample)];
}

std::span<const double> SequenceParameters::of(const SampleChunk& chunk,
                                               std::vector<double>& room) const {
    const auto count = static_cast<std::size_t>(chunk.count);
    if (!rule_) return given_.subspan(static_cast<std::size_t>(chunk.first), count);
    if (room.size() < count) room.resize(count);
    double* t = room.data();
    if (!by_length()) {
        number(t, static_cast<int>(chunk.count), static_cast<double>(chunk.first),
               steps_of(samples_, closure_));
    } else {
        accumulate_steps(chunk.points, chunk.count, dim_, chunk.before, *rule_, t);
        normalise(t, chunk.count, offsets_[static_cast<std::size_t>(chunk.index())], total_);
        if (closure_ == Closure::open && chunk.first + chunk.count == samples_) t[count - 1] = 1;
    }
    return {t, count};
}

} // namespace batten
