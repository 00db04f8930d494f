#include <batten/problem/subset.hpp>

#include <batten/system/constraints.hpp>

#include <algorithm>

namespace batten {

namespace {

PointSet rows_of(const Points& points, const std::vector<Index>& kept) {
    PointSet result(static_cast<Index>(kept.size()), points.dim());
    for (Index i = 0; i < result.size(); ++i)
        std::ranges::copy(points[kept[static_cast<std::size_t>(i)]], result[i].begin());
    return result;
}

} // namespace

Subset Subset::without(const std::vector<Index>& left_out, Index count) {
    std::vector<Index> kept;
    auto next = left_out.begin();
    for (Index i = 0; i < count; ++i) {
        while (next != left_out.end() && *next < i) ++next;
        if (next == left_out.end() || *next != i) kept.push_back(i);
    }
    return {std::move(kept), count};
}

Subset Subset::keeping(std::vector<Index> kept, Index count) {
    return {std::move(kept), count};
}

Index Subset::place(Index i) const {
    return std::ranges::lower_bound(kept_, i) - kept_.begin();
}

Samples Subset::of(const Samples& samples) const {
    Samples result = samples;
    if (whole()) return result;
    result.points = rows_of(samples.points, kept_);
    result.weights = of(samples.weights);
    if (!samples.grid.empty()) {
        result.grid.clear();
        result.order = Order::none;
    }
    return result;
}

Parameters Subset::of(const Parameters& parameters) const {
    if (whole()) return parameters;
    if (parameters.is_scattered()) return {{}, rows_of(parameters.scattered, kept_)};
    if (parameters.axes.size() == 1) return {{of(parameters.axes[0])}, {}};
    PointSet rows(size(), parameters.axis_count());
    for (Index i = 0; i < size(); ++i)
        std::ranges::copy(parameter_of(parameters, original(i)), rows[i].begin());
    return {{}, std::move(rows)};
}

std::vector<double> Subset::of(const std::vector<double>& values) const {
    if (values.empty() || whole()) return values;
    std::vector<double> result;
    result.reserve(kept_.size());
    for (Index i : kept_) result.push_back(values[static_cast<std::size_t>(i)]);
    return result;
}

HoldOptions Subset::of(HoldOptions hold) const {
    const auto left = [&](Index i) { return std::ranges::binary_search(kept_, i); };
    std::erase_if(hold.interpolate, [&](Index i) { return !left(i); });
    std::erase_if(hold.tangents, [&](const HeldTangent& tangent) { return !left(tangent.sample); });
    for (Index& i : hold.interpolate) i = place(i);
    for (HeldTangent& tangent : hold.tangents) tangent.sample = place(tangent.sample);
    return hold;
}

FitOptions Subset::of(FitOptions options) const {
    options.hold = of(std::move(options.hold));
    if (auto& given = options.shape.parameters) given = of(*given);
    ToleranceOptions& tolerance = options.tolerance;
    tolerance.per_sample = of(tolerance.per_sample);
    std::erase_if(tolerance.corner_samples,
                  [&](Index i) { return !std::ranges::binary_search(kept_, i); });
    for (Index& i : tolerance.corner_samples) i = place(i);
    return options;
}

Problem Subset::of(const Problem& problem) const {
    Problem result = problem;
    result.samples = of(problem.samples);
    result.parameters = of(problem.parameters);
    result.tolerance = of(problem.tolerance);
    result.options = of(problem.options);
    return result;
}

std::vector<double> Subset::spread(const std::vector<double>& t) const {
    std::vector<double> all;
    all.reserve(static_cast<std::size_t>(count_));
    std::size_t next = 0;
    for (Index i = 0; i < count_; ++i) {
        if (next < kept_.size() && kept_[next] == i) {
            all.push_back(t[next++]);
        } else if (next == 0 || next == t.size()) {
            all.push_back(next == 0 ? t.front() : t.back());
        } else {
            const double part = static_cast<double>(i - kept_[next - 1]) /
                                static_cast<double>(kept_[next] - kept_[next - 1]);
            all.push_back(t[next - 1] + part * (t[next] - t[next - 1]));
        }
    }
    return all;
}

} // namespace batten
