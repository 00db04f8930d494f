#include <batten/search/curve_calmer.hpp>

#include <batten/search/curve_knots.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The integral of the squared second derivative that the samples show where they bend by more
/// than twice the tolerance, for parameters over [0, 1].
double shown_roughness(const CurveTask& task) {
    const Points& q = task.samples.points;
    const std::vector<double>& t = task.parameters;
    double sum = 0;
    for (Index i = 1; i + 1 < q.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double before = t[k] - t[k - 1];
        const double after = t[k + 1] - t[k];
        if (!(before > 0) || !(after > 0)) continue;
        double square = 0;
        for (Index d = 0; d < q.dim(); ++d) {
            const double chord = (after * q(i - 1, d) + before * q(i + 1, d)) / (before + after);
            square += (q(i, d) - chord) * (q(i, d) - chord);
        }
        const double bend = std::max(0.0, std::sqrt(square) - 2 * task.tolerance[k]);
        const double second = 2 * bend / (before * after);
        sum += second * second * (before + after) / 2;
    }
    const double length = task.closure == Closure::closed ? 1 : t.back() - t.front();
    return sum * length * length * length;
}

} // namespace

CurveTask calmer(CurveTask task, double part) {
    const double square = tightest(task) * tightest(task);
    task.roughness = part * square / std::max(shown_roughness(task), square);
    return task;
}

void see_calmer(const CurveTask& task, const KnotVector& knots, ClosestSeen& closest) {
    constexpr double least = 1e-6;
    constexpr double most = 1e12;
    constexpr double step = 4;
    constexpr int halvings = 4;
    constexpr int rounds = 8;
    const auto acceptable_with = [&](double part) {
        CurveTrial trial = first_trial(task, knots);
        settle(calmer(task, part), trial, rounds, KnotShift::none);
        closest.see(task, trial);
        return acceptable(task, trial);
    };
    double part = least;
    while (part < most && !acceptable_with(part)) part *= step;
    double wild = part / step; // or never tried: less than the least is as good as none
    for (int k = 0; k < halvings && part < most; ++k) {
        const double middle = std::sqrt(wild * part);
        (acceptable_with(middle) ? part : wild) = middle;
    }
}

} // namespace batten
