#include <batten/fit/rescale.hpp>

#include <batten/core/vectors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

PointSet scaled(PointSet points, double factor) {
    scale(points.values(), factor);
    return points;
}

Spline scaled(const Spline& spline, double factor) {
    return {spline.axes(), scaled(spline.control_points(), factor)};
}

/// Settings that are lengths, or as long as gradients; MLSPIA's lambda is a part.
void scale(Settings& settings, std::string_view method, double factor) {
    for (const std::string_view name : {"t_c", "inner_tolerance", "lambda"}) {
        const auto found = settings.find(std::string(name));
        if (found != settings.end() && (name != "lambda" || method == "clspia"))
            found->second *= factor;
    }
}

Observer unscaled(const Observer& observer, double factor) {
    if (!observer) return {};
    return [observer, factor](const Iteration& now) {
        const PointSet control = scaled(now.control, 1 / factor);
        return observer({now.number, control, now.gradient_norm / factor, now.largest_move / factor,
                         now.constraint_error / factor / factor});
    };
}

} // namespace

Samples rescaled(Samples samples, double factor) {
    samples.points = Points(scaled(PointSet(samples.points), factor));
    return samples;
}

FitOptions rescaled(FitOptions options, double factor) {
    options.tolerance.value *= factor;
    scale(options.tolerance.per_sample, factor);
    for (HeldTangent& tangent : options.hold.tangents) scale(tangent.value, factor);
    for (HeldBoundary& boundary : options.hold.boundaries)
        boundary.spline = scaled(boundary.spline, factor);
    options.method.control = scaled(std::move(options.method.control), factor);
    options.method.before = scaled(std::move(options.method.before), factor);
    scale(options.method.settings, options.method.name, factor);
    options.stop.gradient *= factor;
    options.stop.deviation *= factor;
    options.observer = unscaled(options.observer, factor);
    options.unit *= factor;
    return options;
}

FitResult rescaled(FitResult result, double factor) {
    result.spline = scaled(result.spline, factor);
    FitReport& report = result.report;
    for (double* length : {&report.deviation.maximum, &report.deviation.rms, &report.gradient_norm,
                           &report.first_gradient_norm, &report.constraint_error,
                           &report.boundary_error, &report.tolerance, &report.largest_tolerance,
                           &report.noise_level, &report.data_size, &report.held_back})
        *length *= factor;
    report.data_size = std::min(report.data_size, std::numeric_limits<double>::max());
    scale(result.deviations, factor);
    scale(report.settings, report.method, factor);
    for (Goal& goal : report.goals)
        if (goal.name != "inflections" && goal.name != "tangents" &&
            goal.name != "relative gradient" && goal.name != "least functional") {
            goal.stated *= factor;
            goal.reached *= factor;
        }
    for (HistoryEntry& entry : report.history) {
        entry.gradient_norm *= factor;
        entry.largest_move *= factor;
        entry.max_deviation *= factor;
        entry.largest_mean *= factor;
        entry.constraint_error *= factor * factor;
    }
    for (Frame& frame : report.frames) frame.control = scaled(std::move(frame.control), factor);
    return result;
}

} // namespace batten
