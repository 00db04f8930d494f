#include <batten/measure/deviation.hpp>

#include <batten/measure/curve_deviation.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index block_size = 4096;

std::vector<double> lengths(const PointSet& values, const Points& points) {
    std::vector<double> result(static_cast<std::size_t>(points.size()));
    for_each_block(points.size(), block_size, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i)
            result[static_cast<std::size_t>(i)] = distance(values[i], points[i]);
    });
    return result;
}

} // namespace

std::string_view to_string(DeviationKind kind) {
    return kind == DeviationKind::parametric ? "parametric" : "distance";
}

std::vector<double> parametric_deviations(const Spline& spline, const Samples& samples,
                                          const Parameters& parameters) {
    if (parameters.is_scattered())
        return lengths(evaluate(spline, parameters.scattered), samples.points);
    if (parameters.axes.size() > 1)
        return lengths(evaluate_grid(spline, parameters.axes), samples.points);
    return curve_deviations(spline, samples.points, parameters.axes[0]);
}

std::vector<double> deviations(const Spline& spline, const Samples& samples,
                               const Parameters& parameters, DeviationKind kind) {
    return kind == DeviationKind::distance ? closest_distances(spline, samples, parameters)
                                           : parametric_deviations(spline, samples, parameters);
}

Deviation summarise(const std::vector<double>& deviations, DeviationKind kind) {
    Deviation result{.maximum = 0, .rms = 0, .worst_sample = 0, .kind = kind};
    double sum = 0;
    for (std::size_t i = 0; i < deviations.size(); ++i) {
        sum += deviations[i] * deviations[i];
        if (deviations[i] > result.maximum) {
            result.maximum = deviations[i];
            result.worst_sample = static_cast<Index>(i);
        }
    }
    result.rms = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, deviations.size())));
    return result;
}

} // namespace batten
