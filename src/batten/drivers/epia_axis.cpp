#include <batten/drivers/epia_axis.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

EpiaAxis::EpiaAxis(int degree, std::vector<double> parameters, std::vector<double> curvature,
                   std::vector<Index> controls, std::vector<Index> alone)
    : degree_(degree),
      parameters_(std::move(parameters)),
      curvature_(std::move(curvature)),
      controls_(std::move(controls)),
      alone_(std::move(alone)) {
    const auto m = static_cast<Index>(parameters_.size());
    if (m < degree + 1)
        throw InvalidInput(
            fmt::format("epia: degree {} needs at least {} distinct samples along an axis, got {}",
                        degree, degree + 1, m));
    for (Index sample : alone_)
        if (!has(sample)) insert(sample);
    while (static_cast<Index>(controls_.size()) < degree + 1) { // halve the widest gap
        std::size_t widest = 1;
        for (std::size_t i = 1; i < controls_.size(); ++i)
            if (controls_[i] - controls_[i - 1] > controls_[widest] - controls_[widest - 1])
                widest = i;
        insert((controls_[widest] + controls_[widest - 1]) / 2);
    }
}

bool EpiaAxis::has(Index sample) const {
    return std::ranges::binary_search(controls_, sample);
}

bool EpiaAxis::is_alone(Index sample) const {
    return std::ranges::find(alone_, sample) != alone_.end();
}

void EpiaAxis::insert(Index sample) {
    controls_.insert(std::ranges::upper_bound(controls_, sample), sample);
}

Index EpiaAxis::fence(Index s, Index e) const {
    if (is_alone(s)) return s + 1;
    if (is_alone(e) || e == s + 1) return e;
    const auto k = [&](Index j) { return curvature_[static_cast<std::size_t>(j)]; };
    const auto [low, high] =
        std::minmax_element(curvature_.begin() + s, curvature_.begin() + e + 1);
    const double flattest = *low;
    const double range = *high - flattest;
    const auto term = [&](Index j) {
        const double bent = range > 0 ? (k(j) - flattest) / range : 0;
        return std::exp(bent) * (parameter(j) - parameter(s)) / (parameter(e) - parameter(s));
    };
    double total = 0;
    for (Index j = s; j < e; ++j) total += term(j); // the second sum of eq. 44 runs to e - 1
    double before = term(s);
    Index best = s + 1;
    double smallest = std::numeric_limits<double>::infinity();
    for (Index w = s + 1; w < e; ++w) {
        const double gap = std::abs(before - (total - before));
        if (gap < smallest) {
            smallest = gap;
            best = w;
        }
        before += term(w);
    }
    return best;
}

std::vector<SampleRange> EpiaAxis::groups() const {
    std::vector<SampleRange> result(controls_.size());
    result.front().begin = 0;
    result.back().end = static_cast<Index>(parameters_.size());
    for (std::size_t i = 1; i < controls_.size(); ++i)
        result[i - 1].end = result[i].begin = fence(controls_[i - 1], controls_[i]);
    return result;
}

KnotVector EpiaAxis::knots() const {
    std::vector<double> own;
    for (Index control : controls_) own.push_back(parameter(control));
    return averaged_knots(own, degree_);
}

} // namespace batten
