#include <batten/drivers/epia_axis.hpp>

#include <batten/core/grid_index.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace batten {

EpiaAxis::EpiaAxis(int degree, Line line, std::vector<Index> controls, std::vector<Index> alone,
                   Index least)
    : degree_(degree),
      line_(std::move(line)),
      controls_(std::move(controls)),
      alone_(std::move(alone)) {
    if (sample_count() < degree + 1)
        throw InvalidInput(
            fmt::format("epia: degree {} needs at least {} distinct samples along an axis, got {}",
                        degree, degree + 1, sample_count()));
    std::ranges::sort(alone_);
    insert(alone_);
    std::vector<Index> between;
    for (std::size_t i = 1; i < controls_.size(); ++i)
        if (is_alone(controls_[i - 1]) && is_alone(controls_[i]))
            between.push_back((controls_[i - 1] + controls_[i]) / 2); // own already if neighbours
    insert(std::move(between));
    while (control_count() < std::max<Index>(least, degree + 1)) { // halve the widest gap
        std::size_t widest = 1;
        for (std::size_t i = 1; i < controls_.size(); ++i)
            if (controls_[i] - controls_[i - 1] > controls_[widest] - controls_[widest - 1])
                widest = i;
        insert({(controls_[widest] + controls_[widest - 1]) / 2});
    }
}

bool EpiaAxis::has(Index sample) const {
    return std::ranges::binary_search(controls_, sample);
}

bool EpiaAxis::is_alone(Index sample) const {
    return std::ranges::binary_search(alone_, sample);
}

Index EpiaAxis::nearest_free(Index sample) const {
    for (Index away = 1; away < sample_count(); ++away)
        for (Index at : {sample - away, sample + away})
            if (at >= 0 && at < sample_count() && !has(at)) return at;
    return sample;
}

bool EpiaAxis::insert(std::vector<Index> samples) {
    std::ranges::sort(samples);
    samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
    std::vector<Index> all;
    std::ranges::set_union(controls_, samples, std::back_inserter(all));
    controls_.swap(all);
    return controls_.size() > all.size();
}

Index EpiaAxis::fence(Index s, Index e) const {
    if (is_alone(s)) return s + 1;
    if (is_alone(e) || e == s + 1) return e;
    const auto k = [&](Index j) { return line_.curvature[static_cast<std::size_t>(j)]; };
    const auto [low, high] =
        std::minmax_element(line_.curvature.begin() + s, line_.curvature.begin() + e + 1);
    const double flattest = *low;
    const double range = *high - flattest;
    const auto term = [&](Index j) {
        const double bent = range > line_.noise ? (k(j) - flattest) / range : 0;
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
    result.back().end = sample_count();
    for (std::size_t i = 1; i < controls_.size(); ++i)
        result[i - 1].end = result[i].begin = fence(controls_[i - 1], controls_[i]);
    return result;
}

KnotVector EpiaAxis::knots() const {
    std::vector<double> own;
    for (Index control : controls_) own.push_back(parameter(control));
    return averaged_knots(own, degree_);
}

std::vector<KnotVector> knots_of(const std::vector<EpiaAxis>& axes) {
    std::vector<KnotVector> result;
    for (const EpiaAxis& axis : axes) result.push_back(axis.knots());
    return result;
}

std::vector<std::vector<SampleRange>> groups_of(const std::vector<EpiaAxis>& axes) {
    std::vector<std::vector<SampleRange>> result;
    for (const EpiaAxis& axis : axes) result.push_back(axis.groups());
    return result;
}

std::vector<Index> shape_of(const std::vector<EpiaAxis>& axes) {
    std::vector<Index> result;
    for (const EpiaAxis& axis : axes) result.push_back(axis.control_count());
    return result;
}

PointSet own_samples(const std::vector<EpiaAxis>& axes, const Samples& samples) {
    const GridIndex net(shape_of(axes));
    const GridIndex grid(samples.shape());
    PointSet result(net.size(), samples.dim());
    net.for_each([&](const GridIndex::Place& place, Index i) {
        GridIndex::Place sample{};
        for (std::size_t k = 0; k < axes.size(); ++k)
            sample[k] = axes[k].controls()[static_cast<std::size_t>(place[k])];
        std::ranges::copy(samples.points[grid.at(sample)], result[i].begin());
    });
    return result;
}

} // namespace batten
