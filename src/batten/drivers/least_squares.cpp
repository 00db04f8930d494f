#include <batten/drivers/least_squares.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/iterate/clspia.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/problem/plan.hpp>
#include <batten/shape/limits.hpp>
#include <batten/solve/cross_validation.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/keep_shape.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// Keeps the polygon of every `stride`-th iteration; once there are twice too many, of every other
/// of these.
class FrameRecorder {
  public:
    explicit FrameRecorder(Index most) : most_(most) {}
    void record(const Iteration& now, std::vector<Frame>& frames) {
        if (most_ == 0 || now.number % stride_ != 0) return;
        frames.push_back({now.number, now.control});
        if (static_cast<Index>(frames.size()) < 2 * most_) return;
        stride_ *= 2;
        std::erase_if(frames, [&](const Frame& frame) { return frame.iteration % stride_ != 0; });
    }

  private:
    Index most_;
    Index stride_ = 1;
};

Observer recording(const FitOptions& options, const DeviationMeasure& deviation,
                   FitReport& report) {
    return [&, frames = FrameRecorder(options.most_frames)](const Iteration& now) mutable {
        frames.record(now, report.frames);
        if (options.keep_history)
            report.history.push_back({now.number, now.gradient_norm, now.largest_move,
                                      deviation(now.control), now.constraint_error});
        if (options.cancelled && options.cancelled()) return Continue::no;
        return options.observer ? options.observer(now) : Continue::yes;
    };
}

/// Samples and parameters without some samples: what CLSPIA approximates.
struct Rest {
    Samples samples;
    Parameters parameters;
};

Rest without(const Samples& samples, const Parameters& parameters,
             const std::vector<Index>& left_out) {
    std::vector<bool> out(static_cast<std::size_t>(samples.size()), false);
    for (Index i : left_out) out[static_cast<std::size_t>(i)] = true;
    const auto kept = static_cast<Index>(std::count(out.begin(), out.end(), false));
    if (kept == 0)
        throw InvalidInput("clspia: every sample is interpolated, none is left to approximate; use "
                           "--method direct");
    PointSet points(kept, samples.dim());
    PointSet rows(kept, parameters.axis_count());
    Rest rest;
    Index at = 0;
    for (Index i = 0; i < samples.size(); ++i) {
        if (out[static_cast<std::size_t>(i)]) continue;
        std::ranges::copy(samples.points[i], points[at].begin());
        std::ranges::copy(parameter_of(parameters, i), rows[at++].begin());
        if (!samples.weights.empty())
            rest.samples.weights.push_back(samples.weights[static_cast<std::size_t>(i)]);
    }
    rest.samples.points = Points(std::move(points));
    if (parameters.axis_count() == 1 && !parameters.is_scattered())
        rest.parameters.axes = {rows.values()};
    else
        rest.parameters.scattered = std::move(rows);
    return rest;
}

DeviationMeasure measuring(const std::vector<KnotVector>& axes, const Samples& samples,
                           const Parameters& parameters) {
    return [&](const PointSet& control) {
        const Spline now = Spline::from_free(axes, control);
        return summarise(parametric_deviations(now, samples, parameters), DeviationKind::parametric)
            .maximum;
    };
}

/// Part of the data's size that counts as hitting a sample.
constexpr double exact_part = 1e-9;

bool convex(const PointSet& control, Closure closure) {
    const std::vector<int> signs = turn_signs(control, closure);
    const bool left = std::ranges::all_of(signs, [](int s) { return s >= 0; });
    return left || std::ranges::all_of(signs, [](int s) { return s <= 0; });
}

} // namespace

StepLimit shape_limit(Preserve preserve, const std::vector<KnotVector>& axes,
                      const PointSet& control, std::string_view method) {
    if (preserve == Preserve::nothing) return {};
    if (axes.size() != 1 || control.dim() != 2)
        throw InvalidInput(fmt::format(
            "preserve: shape is kept for curves in the plane, not for {} in dimension {}",
            axes.size() == 1 ? "a curve" : "a surface or volume", control.dim()));
    const Closure closure = axes[0].closure();
    if (preserve == Preserve::convexity && !convex(control, closure))
        throw InvalidInput("preserve convexity: the initial control polygon is not convex");
    if (method == "pia" && preserve == Preserve::convexity)
        return [closure](const PointSet& polygon, PointSet& moves) {
            keep_turns(polygon, moves, closure);
        };
    return [closure](const PointSet& polygon, PointSet& moves) {
        keep_inflections(polygon, moves, closure);
    };
}

void run(Method& method, PointSet& control, const FitOptions& options,
         const std::vector<KnotVector>& axes, const DeviationMeasure& deviation, FitReport& report,
         const std::vector<double>& centre) {
    const StepLimit limit = shape_limit(options.hold.preserve, axes, control, report.method);
    const Summary summary =
        iterate(method, control, options.stop,
                {recording(options, deviation, report), limit, deviation, centre});
    report.termination = summary.termination;
    report.iterations = summary.iterations;
    report.gradient_norm = summary.gradient_norm;
    report.first_gradient_norm = summary.first_gradient_norm;
    report.observed_rate = summary.observed_rate;
    report.predicted_rate = method.predicted_rate();
    report.settings = method.settings();
    if (const std::string note = method.note(); !note.empty()) report.notes.push_back(note);
    if (limit)
        report.inflections = inflection_count(centre.empty() ? control : uncentred(control, centre),
                                              axes[0].closure());
}

namespace {

/// The direct answer whose polygon bends no more often than the initial one, or not at all.
PointSet solve_shaped(const NormalSystem& system, const Constraints& constraints,
                      const Samples& samples, const Parameters& parameters,
                      const FitOptions& options, FitReport& report) {
    const PointSet initial = initial_control(samples, parameters, system.axes(), options.method);
    shape_limit(options.hold.preserve, system.axes(), initial, "direct"); // refuses what has none
    const Closure closure = system.axes()[0].closure();
    const Index most =
        options.hold.preserve == Preserve::convexity ? 0 : inflection_count(initial, closure);
    PointSet control = solve_with_inflections(system, constraints, most);
    report.inflections = inflection_count(control, closure);
    if (report.inflections > most) {
        report.termination = Termination::stalled;
        report.notes.push_back(
            fmt::format("the shape could not be kept with these control points: {} inflections "
                        "where the initial polygon has {}; more control points may do",
                        report.inflections, most));
    }
    return control;
}

} // namespace

namespace {

/// The given or cross-validated smoothing, entered into the system.
Smoothing add_smoothing(NormalSystem& system, const SmoothOptions& options) {
    const Smoothing smoothing = options.lambda > 0 ? Smoothing{.lambda = options.lambda}
                                                   : cross_validated(system, options.order);
    system.add_roughness(smoothing.lambda, options.order);
    return smoothing;
}

} // namespace

PointSet least_squares(const std::vector<KnotVector>& axes, const Samples& samples,
                       const Parameters& parameters, const Constraints& constraints,
                       const FitOptions& options, FitReport& report) {
    Stopwatch watch;
    const bool clspia = report.method == "clspia";
    const Rest rest = clspia && !constraints.empty()
                          ? without(samples, parameters, options.hold.interpolate)
                          : Rest{samples, parameters};
    const auto system = assemble(axes, rest.samples, rest.parameters);
    report.seconds.emplace_back("assemble", watch.lap());
    if (options.smooth.wanted) {
        const Smoothing smoothing = add_smoothing(*system, options.smooth);
        report.smoothing = smoothing.lambda;
        report.freedom = smoothing.freedom;
        report.noise_level = smoothing.noise;
        report.seconds.emplace_back("smoothing", watch.lap());
    }
    const Constraints local = constraints.centred(system->centre());
    if (report.method == "direct") {
        check_settings(method_entry("direct"), options.method.settings);
        const PointSet control =
            uncentred(options.hold.preserve == Preserve::nothing
                          ? solve_direct(*system, local)
                          : solve_shaped(*system, local, samples, parameters, options, report),
                      system->centre());
        report.seconds.emplace_back("solve", watch.lap());
        return control;
    }
    PointSet control =
        centred(initial_control(samples, parameters, axes, options.method), system->centre());
    std::unique_ptr<Method> method;
    if (clspia) {
        const MethodEntry& entry = method_entry("clspia");
        const Settings& s = options.method.settings;
        check_settings(entry, s);
        const Constraints exact = with_best_lengths(*system, local.independent(system->size()));
        const ClspiaSettings settings{setting(s, "mu"), setting(s, "mu_1"),
                                      setting(s, "inner_tolerance"),
                                      setting(entry, s, "eigenvalue_tolerance")};
        method = std::make_unique<Clspia>(*system, exact, exact_part * diagonal(samples.points),
                                          settings);
    } else {
        method = make_method(report.method, *system, options.method.settings);
    }
    run(*method, control, options, axes, measuring(axes, samples, parameters), report,
        system->centre());
    report.seconds.emplace_back("solve", watch.lap());
    return uncentred(control, system->centre());
}

} // namespace batten
