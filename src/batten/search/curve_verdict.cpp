#include <batten/search/curve_verdict.hpp>

#include <batten/measure/between_samples.hpp>
#include <batten/measure/inflections.hpp>
#include <batten/search/search.hpp>
#include <batten/shape/polygon.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr Index most_for_inflections = 20000; // samples: beyond it they show noise

} // namespace

bool can_show_inflections(const CurveTask& task) {
    return task.samples.dim() == 2 && task.samples.size() <= most_for_inflections;
}

double visible_height(const CurveTask& task, double tolerance) {
    return task.most_inflections >= 0 ? tolerance : tolerance / 4;
}

Index shown_inflections(const CurveTask& task, double height) {
    return visible_inflections(task.samples.points, height, task.closure);
}

Index curve_inflections(const CurveTrial& trial, double height) {
    const std::vector<double> breaks = trial.knots.breakpoints();
    constexpr Index steps = 32; // per piece
    PointSet t(static_cast<Index>(breaks.size() - 1) * steps + 1, 1);
    for (Index i = 0; i < t.size(); ++i) {
        const Index piece = std::min(i / steps, static_cast<Index>(breaks.size()) - 2);
        const auto b = static_cast<std::size_t>(piece);
        t(i, 0) = breaks[b] +
                  (breaks[b + 1] - breaks[b]) * static_cast<double>(i - piece * steps) / steps;
    }
    return visible_inflections(evaluate(spline_of(trial), t), height, trial.knots.closure());
}

bool near_interpolation(const CurveTask& task, const CurveWithin& found) {
    return static_cast<double>(found.trial.knots.free_count()) >
           smooth_part * static_cast<double>(task.samples.size());
}

namespace {

/// Counts the inflections of curve and samples where they can be told.
void count_inflections(const CurveTask& task, const CurveWithin& found, FitReport& report) {
    if (!can_show_inflections(task)) return;
    const double height = visible_height(task, report.tolerance);
    report.curve_inflections = curve_inflections(found.trial, height);
    report.data_inflections = shown_inflections(task, height);
    if (task.most_inflections >= 0)
        report.inflections = inflection_count(found.trial.control, task.closure);
    report.allowed_inflections =
        task.hold.preserve == Preserve::nothing ? -1 : task.most_inflections;
}

} // namespace

void judge(const CurveTask& task, const CurveWithin& found, double noise,
           const std::string& why_not, FitReport& report) {
    bool met = report.termination == Termination::tolerance_met;
    const BetweenSamples between = check_between(spline_of(found.trial), task.samples.points,
                                                 found.trial.parameters, task.tolerance);
    report.between_samples = between.excess;
    count_inflections(task, found, report);
    const bool wild = met && between.excess > wild_part;
    if (wild) {
        met = false;
        report.termination = Termination::tolerance_not_met;
    }
    const Index n = found.trial.knots.free_count();
    const Index m = task.samples.size();
    const bool near = near_interpolation(task, found);
    report.noise_level = near || !met ? noise : 0;
    report.verdict = met    ? "met"
                     : wild ? "not met: every sample is within, but the curve is wild between some"
                            : why_not;
    if (met && near)
        report.verdict += fmt::format(", but it nearly interpolates: {} control points for {} "
                                      "samples; noise level seen in them {:.3g}",
                                      n, m, noise);
    if (!between.good && (met || wild))
        report.verdict +=
            between.loops > 0
                ? fmt::format("; between samples {} and the next the curve has a loop",
                              between.worst_sample)
                : fmt::format(
                      "; between samples {} and the next the curve strays {:.2g} times as far as "
                      "allowed",
                      between.worst_sample, between.excess);
    if (met && report.curve_inflections > report.data_inflections)
        report.verdict += fmt::format("; the curve has {} inflections, the samples show {}",
                                      report.curve_inflections, report.data_inflections);
}

} // namespace batten
