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
    return task.samples.dim() == 2 && samples_in_all(task) <= most_for_inflections;
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

namespace {

/// The inflections of curve and samples, where they can be told.
FitReport inflections_of(const CurveTask& task, const CurveTrial& trial) {
    FitReport report;
    report.tolerance = tightest(task);
    if (!can_show_inflections(task)) return report;
    const double height = visible_height(task, report.tolerance);
    report.curve_inflections = curve_inflections(trial, height);
    report.data_inflections = shown_inflections(task, height);
    if (task.most_inflections >= 0)
        report.inflections = inflection_count(trial.control, task.closure);
    if (task.hold.preserve != Preserve::nothing) report.allowed_inflections = task.most_inflections;
    return report;
}

std::string between_words(const BetweenSamples& between) {
    if (between.good) return {};
    if (between.loops > 0)
        return fmt::format("; between samples {} and the next the curve has a loop",
                           between.worst_sample);
    return fmt::format("; between samples {} and the next the curve strays {:.2g} times as far as "
                       "allowed",
                       between.worst_sample, between.excess);
}

} // namespace

FitReport judged(const CurveTask& task, const CurveOutcome& outcome, Index allowed,
                 double deviation) {
    const CurveWithin& found = outcome.found;
    const Index n = found.trial.knots.free_count();
    const Index m = task.samples.size();
    FitReport report = inflections_of(task, found.trial);
    report.stages = found.stages;
    report.searched_samples = found.searched;
    report.full_checks = found.full_checks;
    report.termination = found.met ? Termination::tolerance_met : Termination::tolerance_not_met;
    report.noise_level = outcome.noise;
    const BetweenSamples between = check_reached(task, found.trial);
    report.between_samples = between.excess;
    report.verdict = found.met ? "met"
                               : not_met_words({.why = outcome.why,
                                                .allowed = allowed,
                                                .noise = outcome.noise,
                                                .control_points = n,
                                                .deviation = deviation,
                                                .unit = task.unit});
    report.verdict += near_interpolation_words(n, m, outcome.noise, task.unit);
    report.verdict += between_words(between);
    if (found.met && report.curve_inflections > report.data_inflections)
        report.verdict += fmt::format("; the curve has {} inflections, the samples show {}",
                                      report.curve_inflections, report.data_inflections);
    return report;
}

} // namespace batten
