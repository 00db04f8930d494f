#include <batten/search/thinned_task.hpp>

#include <batten/core/distinct.hpp>
#include <batten/search/curve_knots.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten {

namespace {

/// What something is said of.
std::vector<Index> marked(const CurveTask& task) {
    std::vector<Index> result = task.hold.interpolate;
    for (const HeldTangent& tangent : task.hold.tangents) result.push_back(tangent.sample);
    result.insert(result.end(), task.corners.begin(), task.corners.end());
    result.insert(result.end(), task.fixed.begin(), task.fixed.end());
    return distinct(std::move(result));
}

/// Adds samples, each with enough beside it for a piece of the curve.
void keep_with_neighbours(const CurveTask& task, const std::vector<Index>& samples,
                          std::vector<Index>& kept) {
    const Index beside = task.degree + 1;
    const Index last = task.samples.size() - 1;
    for (Index i : samples)
        for (Index k = std::max<Index>(0, i - beside); k <= std::min(last, i + beside); ++k)
            kept.push_back(k);
}

/// Noise is sharp all over.
bool few_sharp(const CurveTask& task, Index stretches) {
    constexpr Index apart = 8;
    return static_cast<Index>(task.sharp->size()) * apart * (task.degree + 1) <= stretches;
}

CurveTask task_of(const CurveTask& whole, const Subset& subset, const Samples& samples) {
    CurveTask task{.samples = samples,
                   .tolerance = subset.of(whole.tolerance),
                   .degree = whole.degree,
                   .closure = whole.closure,
                   .hold = subset.of(whole.hold),
                   .most_inflections = whole.most_inflections,
                   .most_turning = whole.most_turning,
                   .roughness = whole.roughness,
                   .parameters = subset.of(whole.parameters),
                   .seam_continuity = whole.seam_continuity,
                   .seam_stated = whole.seam_stated,
                   .between = whole.between,
                   .unit = whole.unit,
                   .cancelled = whole.cancelled};
    task.stand_for = samples_in_all(whole);
    return task;
}

} // namespace

std::vector<Index> representatives(const CurveTask& task, Index stretches) {
    const Index m = task.samples.size();
    const std::vector<double>& t = task.parameters;
    const double parts = static_cast<double>(stretches);
    const double length = t.back() - t.front();
    std::vector<Index> kept{0, m - 1};
    double taken = -1; // the last stretch of the parameters that has its sample
    for (Index i = 0; i < m; ++i) {
        const double part =
            std::floor((t[static_cast<std::size_t>(i)] - t.front()) / length * parts);
        const bool first_here = part > taken;
        taken = std::max(taken, part);
        if (first_here || i * stretches / m != (i - 1) * stretches / m) kept.push_back(i);
    }
    keep_with_neighbours(task, marked(task), kept);
    if (task.sharp && few_sharp(task, stretches)) keep_with_neighbours(task, *task.sharp, kept);
    return distinct(std::move(kept));
}

ThinnedTask::ThinnedTask(const CurveTask& whole, const std::vector<Index>& kept)
    : whole_(whole),
      subset_(Subset::keeping(kept, whole.samples.size())),
      samples_(subset_.of(whole.samples)),
      task_(task_of(whole, subset_, samples_)) {
    task_.corners = placed(whole.corners);
    task_.fixed = placed(whole.fixed);
    if (!whole.sharp) return;
    const bool all = std::ranges::includes(kept, *whole.sharp);
    task_.sharp = all ? placed(*whole.sharp) : std::vector<Index>{};
}

std::vector<Index> ThinnedTask::placed(const std::vector<Index>& samples) const {
    std::vector<Index> result;
    for (Index i : samples) result.push_back(subset_.place(i));
    return result;
}

std::vector<Index> ThinnedTask::original(std::vector<Index> samples) const {
    for (Index& i : samples) i = original(i);
    return samples;
}

CurveTrial ThinnedTask::carried(const CurveTrial& trial) const {
    constexpr int corrections = 2;
    const std::vector<double>& u = whole_.parameters;
    const std::vector<double>& v = trial.parameters;
    CurveTrial all = trial;
    all.parameters.clear();
    all.parameters.reserve(u.size());
    const Index last = subset_.size() - 1;
    const bool closed = whole_.closure == Closure::closed;
    for (Index k = 0; k <= last; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const auto from = static_cast<std::size_t>(original(k));
        const auto to = k < last ? static_cast<std::size_t>(original(k + 1)) : u.size();
        const double u_next = k < last ? u[to] : u[0] + (closed ? 1 : 0);
        const double v_next = k < last ? v[at + 1] : trial.knots.end();
        const double slope = u_next > u[from] ? (v_next - v[at]) / (u_next - u[from]) : 0;
        for (std::size_t i = from; i < to; ++i)
            all.parameters.push_back(std::clamp(v[at] + slope * (u[i] - u[from]), v[at], v_next));
    }
    follow(whole_, all, corrections);
    return all;
}

CurveTrial ThinnedTask::restricted(const CurveTrial& all, const ThinnedTask& other,
                                   const std::vector<double>& before) const {
    CurveTrial trial = all;
    trial.parameters = subset_.of(all.parameters);
    trial.ratio = subset_.of(all.ratio);
    trial.weights.clear();
    for (Index i : subset_.kept()) {
        const Index next = std::min(other.subset_.place(i), other.subset_.size() - 1);
        const double weight = before[static_cast<std::size_t>(next)];
        const bool same = other.original(next) == i || next == 0;
        trial.weights.push_back(
            same ? weight : std::max(weight, before[static_cast<std::size_t>(next - 1)]));
    }
    return trial;
}

bool add_offenders(const CurveTrial& all, std::vector<Index>& kept, std::vector<Index>& offenders) {
    constexpr double nearly = 0.97; // what may break it next
    constexpr double unseen_shape = 2;
    constexpr Index parts = 8;
    const auto m = static_cast<Index>(all.ratio.size());
    std::vector<Index> added;
    for (std::size_t k = 0; k < kept.size(); ++k) {
        const Index from = kept[k] + 1;
        const Index to = k + 1 < kept.size() ? kept[k + 1] : m;
        const auto first = all.ratio.begin() + from;
        const auto worst = std::max_element(first, all.ratio.begin() + to);
        if (from >= to || *worst <= nearly) continue;
        added.push_back(worst - all.ratio.begin());
        if (*worst <= unseen_shape) continue;
        for (Index part = 1; part < parts; ++part)
            added.push_back(std::min(to - 1, from + (to - from) * part / parts));
    }
    for (std::vector<Index>* samples : {&kept, &offenders}) {
        samples->insert(samples->end(), added.begin(), added.end());
        *samples = distinct(std::move(*samples));
    }
    return !added.empty();
}

} // namespace batten
