#include <batten/drivers/picked_knots.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

PickedKnots::PickedKnots(Index samples, int degree, Index n, Closure closure, KnotPlacement rule)
    : degree_(degree),
      closure_(closure),
      samples_(samples),
      places_(knot_places(samples, degree, n, closure, rule)) {
    for (const KnotPlace& place : places_) {
        needed_.push_back(place.before);
        needed_.push_back(std::min(place.before + 1, samples - 1));
    }
}

void PickedKnots::take(Index first, std::span<const double> values, double before) {
    while (values_.size() < needed_.size()) {
        const auto at = static_cast<std::size_t>(needed_[values_.size()] - first);
        if (at >= values.size()) return;
        values_.push_back(before + values[at]);
    }
}

void PickedKnots::divide(double whole) {
    for (double& value : values_) value /= whole;
}

KnotVector PickedKnots::knots(double front, double back) const {
    std::vector<double> interior;
    for (std::size_t j = 0; j < places_.size(); ++j) {
        const bool last = places_[j].before + 1 == samples_;
        interior.push_back(
            std::lerp(values_[2 * j], last ? 1 : values_[2 * j + 1], places_[j].part));
    }
    const bool closed = closure_ == Closure::closed;
    return knots_around(degree_, interior, closed ? 0 : front, closed ? 1 : back, closure_);
}

} // namespace batten
