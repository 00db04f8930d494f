#include <batten/fit/fit.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/epia_driver.hpp>
#include <batten/drivers/least_squares.hpp>
#include <batten/drivers/pia_driver.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/parametrize/noise_aware.hpp>
#include <batten/problem/held.hpp>
#include <batten/problem/plan.hpp>
#include <batten/robust/outliers.hpp>
#include <batten/search/tolerance.hpp>
#include <batten/system/collocation.hpp>

#include <fmt/format.h>

namespace batten {

namespace {

void stop_if_cancelled(const FitOptions& options) {
    if (options.cancelled && options.cancelled()) throw Cancelled("the fit was cancelled");
}

/// Words for what the samples leave undetermined, axis by axis; nothing when all is determined or
/// nobody can tell cheaply.
std::string undetermined_axes(const std::vector<KnotVector>& axes, const Parameters& parameters) {
    for (std::size_t k = 0; k < parameters.axes.size(); ++k)
        if (const auto words = undetermined(axes[k], parameters.axes[k]))
            return fmt::format("axis {}: {}", k, *words);
    return {};
}

/// The method to run, and why when the caller left it open.
std::string choose_method(const FitOptions& options, const std::string& gap,
                          const Parameters& parameters, FitReport& report) {
    const std::string& name = options.method.name;
    const bool exact = options.hold.equalities();
    const bool shape = options.hold.preserve != Preserve::nothing;
    if (name == "direct" && !gap.empty())
        throw InvalidInput(fmt::format(
            "{}: the direct solver cannot determine every control point (Schoenberg-Whitney); "
            "use an iterative method such as --method cg, or --smooth",
            gap));
    if (name != "auto" && name != "direct" && name != "clspia" && exact)
        throw InvalidInput(fmt::format(
            "method {} cannot interpolate samples exactly; use direct or clspia", name));
    if (name != "auto") return name;
    if (shape && gap.empty()) {
        report.method_reason = "the shape is kept by quadratic programs";
        return "direct";
    }
    if (shape) {
        report.method_reason = gap + ": the shape is kept step by step";
        return exact ? "clspia" : "mlspia";
    }
    if (parameters.is_scattered() && !exact && !options.smooth.wanted) {
        report.method_reason = "a cloud: conjugate gradients, preconditioned axis by axis, cost "
                               "less than a sparse factorisation";
        return "cg";
    }
    if (gap.empty()) {
        report.method_reason =
            exact ? "exact samples: one saddle-point solve"
                  : "fixed knots and enough samples: one solve is exact and fastest";
        return "direct";
    }
    if (exact)
        throw InvalidInput(
            gap +
            ": samples cannot be interpolated while others leave control points undetermined");
    report.method_reason = gap + ": an iteration leaves what no sample determines where it starts";
    return "cg";
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

/// What smoothing decides where the caller left it open: enough control points, and parameters of
/// a noisy sequence.
void prepare_smoothing(const Samples& samples, int order, ShapeOptions& shape) {
    for (int degree : shape.degree)
        if (degree < order)
            throw InvalidInput(fmt::format("smoothing: the derivative of order {} vanishes for "
                                           "degree {}",
                                           order, degree));
    if (shape.control_points.empty() && shape.knots.empty())
        shape.control_points = smoothing_size(samples, shape);
    const bool chords = !shape.parameters && shape.parametrization == Parametrization::chord;
    if (chords && samples.grid.empty() && samples.size() > 20)
        shape.parameters = {{noise_aware_parameters(samples.points, shape.closures[0])}, {}};
}

/// A fit with stated knots or a stated number of control points, by least squares.
FitResult fit_fixed(const Samples& samples, FitOptions options) {
    if (options.smooth.wanted) prepare_smoothing(samples, options.smooth.order, options.shape);
    FitResult result;
    FitReport& report = result.report;
    Stopwatch watch;
    const AxisPlan plan = plan_axes(samples, options.shape);
    check_held(options.hold, samples, plan.degree, plan.closures);
    result.parameters = parameters_for_boundaries(
        samples, choose_parameters(samples, options.shape, plan), options.hold.boundaries);
    note_duplicates(result.parameters, report);
    report.seconds.emplace_back("parametrize", watch.lap());
    stop_if_cancelled(options);
    std::vector<KnotVector> axes = choose_knots(result.parameters, options.shape, plan);
    for (std::size_t k = 0; k < axes.size(); ++k)
        axes[k] = knots_for_boundaries(axes[k], static_cast<int>(k), options.hold.boundaries);
    // a smooth spline is determined where there are no samples, too
    const std::string gap = options.smooth.wanted ? "" : undetermined_axes(axes, result.parameters);
    report.method = choose_method(options, gap, result.parameters, report);
    const Constraints constraints =
        held_constraints(axes, samples, result.parameters, options.hold);
    report.seconds.emplace_back("knots", watch.lap());
    stop_if_cancelled(options);
    PointSet control;
    try {
        control = least_squares(axes, samples, result.parameters, constraints, options, report);
    } catch (const SolverError& error) {
        const bool plain = options.method.name == "auto" && report.method == "direct" &&
                           constraints.empty() && !options.smooth.wanted &&
                           options.hold.preserve == Preserve::nothing;
        if (options.smooth.lambda > 0)
            throw InvalidInput(fmt::format("smoothing by {}: {}; another factor may do",
                                           options.smooth.lambda, error.what()));
        if (!plain) throw;
        report.method = "cg";
        report.method_reason =
            fmt::format("{}: an iteration leaves it where it starts", error.what());
        control = least_squares(axes, samples, result.parameters, constraints, options, report);
    }
    stop_if_cancelled(options);
    result.spline = Spline::from_free(axes, control);
    return result;
}

/// Fills in what every fit's report says of samples, spline and deviation.
void describe(FitResult& result, const Samples& samples, const FitOptions& options) {
    FitReport& report = result.report;
    constexpr const char* kinds[] = {"curve", "surface", "volume"};
    report.kind = kinds[result.spline.axis_count() - 1];
    report.samples = samples.size();
    report.dim = samples.dim();
    report.control_shape = result.spline.control_shape();
    for (const KnotVector& axis : result.spline.axes()) {
        report.degree.push_back(axis.degree());
        report.closures.push_back(axis.closure());
    }
    report.notes.insert(report.notes.begin(), samples.notes.begin(), samples.notes.end());
    report.data_size = diagonal(samples.points);
    const std::vector<double> deviations =
        parametric_deviations(result.spline, samples, result.parameters);
    report.deviation = summarise(deviations, report.deviation.kind);
    report.interpolated = static_cast<Index>(options.hold.interpolate.size());
    for (Index i : options.hold.interpolate)
        report.constraint_error =
            std::max(report.constraint_error, deviations[static_cast<std::size_t>(i)]);
    report.tangents = static_cast<Index>(options.hold.tangents.size());
    report.tangent_error =
        tangent_error(result.spline, samples, result.parameters, options.hold.tangents);
    report.boundaries = static_cast<Index>(options.hold.boundaries.size());
}

/// A tolerance below what numbers as large as the coordinates can tell apart is not met, whatever
/// the search found relative to the first sample.
void judge_rounding(const FitOptions& options, FitReport& report) {
    const bool one_for_all = options.tolerance.stated() && options.tolerance.per_sample.empty();
    if (!one_for_all || report.termination != Termination::tolerance_met ||
        report.deviation.maximum <= report.tolerance * (1 + 1e-9))
        return;
    report.termination = Termination::tolerance_not_met;
    report.verdict = "not met: it is below what the coordinates, as large as they are, can tell "
                     "apart; shift them towards zero";
}

FitResult fit_all(const Samples& samples, const FitOptions& options) {
    const std::string& method = options.method.name;
    FitResult result = method == "pia"              ? fit_pia(samples, options)
                       : method == "epia"           ? fit_epia(samples, options)
                       : options.tolerance.stated() ? fit_to_tolerance(samples, options)
                                                    : fit_fixed(samples, options);
    Stopwatch watch;
    describe(result, samples, options);
    judge_rounding(options, result.report);
    result.report.seconds.emplace_back("deviation", watch.lap());
    return result;
}

} // namespace

FitResult fit(const Samples& samples, const FitOptions& options) {
    const ThreadLimit limit(options.threads);
    check(samples);
    check_settings(method_entry(options.method.name), options.method.settings);
    stop_if_cancelled(options);
    if (options.outliers == Outliers::count) return fit_all(samples, options);
    Stopwatch watch;
    const std::vector<Index> outliers = find_outliers(samples, options);
    const WithoutOutliers rest = without_outliers(samples, options, outliers);
    const double seconds = watch.lap();
    FitResult result = fit_all(rest.samples, rest.options);
    account_for(samples, options, rest, outliers, result);
    result.report.seconds.emplace_back("outliers", seconds);
    return result;
}

} // namespace batten
