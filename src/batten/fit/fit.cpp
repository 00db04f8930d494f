#include <batten/fit/fit.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/fit/plan.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/solve/direct.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// Names a stage's seconds in the report and stops a cancelled fit between stages.
class Stages {
  public:
    Stages(FitReport& report, const FitOptions& options) : report_(report), options_(options) {}
    void done(const char* stage) {
        report_.seconds.emplace_back(stage, watch_.lap());
        if (options_.cancelled && options_.cancelled()) throw Cancelled("the fit was cancelled");
    }

  private:
    FitReport& report_;
    const FitOptions& options_;
    Stopwatch watch_;
};

/// Words for what the samples leave undetermined, axis by axis; nothing when all is determined.
std::string undetermined_axes(const std::vector<KnotVector>& axes, const Parameters& parameters) {
    for (std::size_t k = 0; k < axes.size(); ++k)
        if (const auto words = undetermined(axes[k], parameters.axes[k]))
            return fmt::format("axis {}: {}", k, *words);
    return {};
}

std::string choose_method(const MethodOptions& options, const std::string& gap, FitReport& report) {
    method_entry(options.name); // refuses unknown names
    if (options.name == "direct" && !gap.empty())
        throw InvalidInput(fmt::format(
            "{}: the direct solver cannot determine every control point (Schoenberg-Whitney); "
            "use an iterative method such as --method cg, or --smooth",
            gap));
    if (options.name != "auto") return options.name;
    report.method_reason =
        gap.empty() ? "fixed knots and enough samples: one banded solve is exact and fastest"
                    : gap + ": an iteration leaves what no sample determines where it starts";
    return gap.empty() ? "direct" : "cg";
}

void note_duplicates(const Parameters& parameters, FitReport& report) {
    for (std::size_t axis = 0; axis < parameters.axes.size(); ++axis) {
        const auto& t = parameters.axes[axis];
        Index equal = 0;
        for (std::size_t i = 1; i < t.size(); ++i) equal += t[i] == t[i - 1] ? 1 : 0;
        if (equal > 0)
            report.notes.push_back(fmt::format(
                "axis {}: {} identical consecutive samples share a parameter and count each", axis,
                equal));
    }
}

Observer recording(const FitOptions& options, FitReport& report) {
    return [&](const Iteration& now) {
        if (options.keep_history)
            report.history.push_back({now.number, now.gradient_norm, now.largest_move});
        if (options.cancelled && options.cancelled()) return Continue::no;
        return options.observer ? options.observer(now) : Continue::yes;
    };
}

DeviationMeasure measuring(const NormalSystem& system, const Samples& samples,
                           const Parameters& parameters) {
    return [&](const PointSet& control) {
        const Spline now = Spline::from_free(system.axes(), uncentred(control, system.centre()));
        return summarise(parametric_deviations(now, samples, parameters), DeviationKind::parametric)
            .maximum;
    };
}

/// Control points relative to the centre, by the method of the report.
PointSet solve(const NormalSystem& system, const Samples& samples, const Parameters& parameters,
               const FitOptions& options, FitReport& report) {
    if (report.method == "direct") {
        check_settings(method_entry("direct"), options.method.settings);
        return solve_direct(system);
    }
    PointSet control = centred(initial_control(samples, parameters, system.axes(), options.method),
                               system.centre());
    const auto method = make_method(report.method, system, options.method.settings);
    const Summary summary =
        iterate(*method, control, options.stop,
                {recording(options, report), {}, measuring(system, samples, parameters)});
    report.termination = summary.termination;
    report.iterations = summary.iterations;
    report.gradient_norm = summary.gradient_norm;
    report.first_gradient_norm = summary.first_gradient_norm;
    report.observed_rate = summary.observed_rate;
    report.predicted_rate = method->predicted_rate();
    report.settings = method->settings();
    return control;
}

void describe(FitReport& report, const Samples& samples, const Spline& spline) {
    constexpr const char* kinds[] = {"curve", "surface", "volume"};
    report.kind = kinds[spline.axis_count() - 1];
    report.samples = samples.size();
    report.dim = samples.dim();
    report.control_shape = spline.control_shape();
    for (const KnotVector& axis : spline.axes()) {
        report.degree.push_back(axis.degree());
        report.closures.push_back(axis.closure());
    }
    report.data_size = diagonal(samples.points);
}

} // namespace

FitResult fit(const Samples& samples, const FitOptions& options) {
    const ThreadLimit limit(options.threads);
    FitResult result;
    FitReport& report = result.report;
    Stages stages(report, options);
    check(samples);
    report.notes = samples.notes;
    const AxisPlan plan = plan_axes(samples, options.shape);
    stages.done("check");
    result.parameters = choose_parameters(samples, options.shape, plan);
    note_duplicates(result.parameters, report);
    stages.done("parametrize");
    const std::vector<KnotVector> axes = choose_knots(result.parameters, options.shape, plan);
    report.method =
        choose_method(options.method, undetermined_axes(axes, result.parameters), report);
    stages.done("knots");
    const auto system = assemble(axes, samples, result.parameters);
    stages.done("assemble");
    const PointSet control = solve(*system, samples, result.parameters, options, report);
    stages.done("solve");
    result.spline = Spline::from_free(axes, uncentred(control, system->centre()));
    describe(report, samples, result.spline);
    report.deviation = summarise(parametric_deviations(result.spline, samples, result.parameters),
                                 DeviationKind::parametric);
    stages.done("deviation");
    return result;
}

} // namespace batten
