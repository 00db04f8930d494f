#include <batten/fit/account.hpp>

#include <batten/measure/deviation.hpp>
#include <batten/measure/grid_deviation.hpp>
#include <batten/parametrize/step_lengths.hpp>
#include <batten/problem/held.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

void note_equal(std::size_t axis, Index equal, std::vector<std::string>& notes) {
    if (equal > 0)
        notes.push_back(fmt::format(
            "axis {}: {} identical consecutive samples share a parameter and count each", axis,
            equal));
}

void note_duplicates(const Parameters& parameters, std::vector<std::string>& notes) {
    for (std::size_t axis = 0; axis < parameters.axes.size(); ++axis) {
        EqualRuns runs;
        runs.add(parameters.axes[axis]);
        note_equal(axis, runs.equal(), notes);
    }
}

/// Largest distance of a sample to be hit from the spline at its own parameter.
double interpolation_error(const Spline& spline, const Samples& samples,
                           const Parameters& parameters, const HoldOptions& hold) {
    double worst = 0;
    for (Index i : hold.interpolate)
        worst = std::max(worst, distance(spline(parameter_of(parameters, i)), samples.points[i]));
    return worst;
}

/// Largest part of its tolerance that a sample is away; the first within is 1 or less, but for
/// rounding.
double part_of_tolerance(const std::vector<double>& deviations,
                         const std::vector<double>& tolerance) {
    double worst = 0;
    for (std::size_t i = 0; i < deviations.size(); ++i)
        worst = std::max(worst, deviations[i] / tolerance[i]);
    return worst;
}

/// What was stated, and what the spline and the driver's course came to.
std::vector<Goal> judged(const FitReport& report, const FitOptions& options, bool tolerance) {
    constexpr double rounding = 1 + 1e-9;
    std::vector<Goal> goals;
    const auto state = [&](const char* name, double stated, double reached) {
        goals.push_back({name, stated, reached, reached <= stated * rounding});
    };
    const StopRule& stop = options.stop;
    if (tolerance) {
        const bool within = report.tolerance_ratio <= rounding &&
                            report.termination != Termination::tolerance_not_met;
        goals.push_back(
            {"tolerance", report.tolerance, report.tolerance_ratio * report.tolerance, within});
    } else if (stop.deviation > 0) {
        state("deviation", stop.deviation, report.deviation.maximum);
    }
    // a direct solution's is rounding, but where something must hold: then it is what that costs
    const bool direct = report.method == "direct" && !options.hold.equalities() &&
                        options.hold.preserve == Preserve::nothing;
    if (stop.gradient > 0 && (report.iterated() || direct))
        state("gradient", stop.gradient, report.gradient_norm);
    const double least = exactness * report.data_size;
    const bool locked = report.held_back > least;        // before its stop
    const bool unfinished = options.smooth.lambda > 0 && // and nobody asked for less
                            report.termination == Termination::iteration_limit &&
                            stop.max_iterations == StopRule().max_iterations;
    if ((locked || unfinished) && stop.relative_gradient > 0)
        state("relative gradient", stop.relative_gradient,
              report.gradient_norm / report.first_gradient_norm);
    constexpr double minimal = 1e-8;
    if (report.above_minimum > minimal) state("least functional", minimal, report.above_minimum);
    if (report.interpolated > 0) state("exact samples", least, report.constraint_error);
    if (report.tangents > 0) state("tangents", exactness, report.tangent_error);
    if (report.boundaries > 0) state("boundaries", least, report.boundary_error);
    if (report.allowed_inflections >= 0)
        state("inflections", static_cast<double>(report.allowed_inflections),
              static_cast<double>(report.inflections));
    return goals;
}

/// The ending that the goals allow: nothing is met or converged while a stated goal is not.
Termination ending(const FitReport& report) {
    const auto missed = [&](std::string_view name) {
        return std::ranges::any_of(
            report.goals, [&](const Goal& goal) { return goal.name == name && !goal.met; });
    };
    const bool over = report.termination == Termination::converged ||
                      report.termination == Termination::tolerance_met;
    if (!over) return report.termination;
    if (missed("tolerance") || missed("deviation")) return Termination::tolerance_not_met;
    if (!report.goals_met()) return Termination::stalled;
    const bool distance_stated = std::ranges::any_of(report.goals, [](const Goal& goal) {
        return goal.name == "tolerance" || goal.name == "deviation";
    });
    return distance_stated ? Termination::tolerance_met : Termination::converged;
}

/// A search that is within tolerance relative to the first sample may not be so in the coordinates.
std::string verdict_of(const FitReport& report, Termination before) {
    if (before != Termination::tolerance_met || report.termination == before) return report.verdict;
    return "not met: it is below what the coordinates, as large as they are, can tell apart; shift "
           "them towards zero";
}

/// What the spline and the samples are.
void describe(FitReport& report, const Spline& spline, Index samples, double size) {
    report.kind = kind_name(spline);
    report.samples = samples;
    report.dim = spline.dim();
    report.control_shape = free_shape(spline.axes());
    for (const KnotVector& axis : spline.axes()) {
        report.degree.push_back(axis.degree());
        report.closures.push_back(axis.closure());
    }
    report.data_size = size;
}

/// What was measured against what was stated.
void judge(FitReport& report, const FitOptions& options, bool tolerance) {
    if (options.keep_history && report.history.empty()) // nothing came before the answer
        report.history.push_back({0, report.gradient_norm, 0, report.deviation.maximum,
                                  report.constraint_error * report.constraint_error});
    report.goals = judged(report, options, tolerance);
    const Termination before = report.termination;
    report.termination = ending(report);
    report.verdict = verdict_of(report, before);
}

} // namespace

FitResult accounted(Passed passed, const std::vector<std::string>& notes,
                    const FitOptions& options) {
    Fitted& fitted = passed.fitted;
    FitReport& report = fitted.report;
    describe(report, fitted.spline, passed.samples, passed.size);
    report.notes = notes;
    note_equal(0, passed.equal, report.notes);
    report.deviation = passed.deviation;
    judge(report, options, false);
    return {std::move(fitted.spline), std::move(report), std::move(fitted.parameters),
            std::move(fitted.deviations)};
}

FitResult accounted(Fitted fitted, const Problem& problem) {
    const Samples& samples = problem.samples;
    const HoldOptions& hold = problem.options.hold;
    const Spline& spline = fitted.spline;
    FitReport report = std::move(fitted.report);
    describe(report, spline, samples.size(), problem.size);
    std::vector<std::string> notes = samples.notes;
    if (problem.tolerance.empty()) note_duplicates(fitted.parameters, notes);
    report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
    std::vector<double> away = std::move(fitted.deviations);
    const bool each = problem.options.keep_per_sample || !problem.tolerance.empty();
    const bool grid =
        fitted.parameters.axes.size() > 1 && fitted.judged_by == DeviationKind::parametric;
    if (away.empty() && grid) {
        if (each) away.resize(static_cast<std::size_t>(samples.size()));
        report.deviation = grid_deviation(spline, samples.points, fitted.parameters.axes,
                                          each ? away.data() : nullptr);
    } else {
        if (away.empty()) away = deviations(spline, samples, fitted.parameters, fitted.judged_by);
        report.deviation = summarise(away, fitted.judged_by);
    }
    report.interpolated = static_cast<Index>(hold.interpolate.size());
    report.constraint_error = interpolation_error(spline, samples, fitted.parameters, hold);
    report.tangents = static_cast<Index>(hold.tangents.size());
    report.tangent_error = tangent_error(spline, samples, fitted.parameters, hold.tangents);
    if (!std::isfinite(report.tangent_error))
        report.notes.emplace_back("tangents: at a sample the spline runs against the stated "
                                  "direction, or has none; no number says how far off that is");
    report.boundaries = static_cast<Index>(hold.boundaries.size());
    report.boundary_error = boundary_error(spline, hold.boundaries);
    if (!problem.tolerance.empty()) {
        report.tolerance_ratio = part_of_tolerance(away, problem.tolerance);
        double largest = 0; // an infinite one is of a sample that may be anywhere
        for (double t : problem.tolerance)
            if (std::isfinite(t)) largest = std::max(largest, t);
        if (largest > report.tolerance) report.largest_tolerance = largest;
    }
    judge(report, problem.options, !problem.tolerance.empty());
    return {std::move(fitted.spline), std::move(report), std::move(fitted.parameters),
            std::move(away)};
}

} // namespace batten
