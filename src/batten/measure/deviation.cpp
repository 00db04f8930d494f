#include <batten/measure/deviation.hpp>

#include <batten/measure/curve_deviation.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Index chunk_size = 4096;

std::vector<double> lengths(const PointSet& values, const Points& points) {
    std::vector<double> result(static_cast<std::size_t>(points.size()));
    const Index dim = points.dim();
    for_each_chunk((points.size() + chunk_size - 1) / chunk_size, [&](Index chunk) {
        const Index end = std::min(points.size(), (chunk + 1) * chunk_size);
        for (Index i = chunk * chunk_size; i < end; ++i) {
            const double* a = values.data() + i * dim;
            const double* b = points.data() + i * dim;
            double square = 0;
            for (Index d = 0; d < dim; ++d) square += (a[d] - b[d]) * (a[d] - b[d]);
            result[static_cast<std::size_t>(i)] = std::sqrt(square);
        }
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
