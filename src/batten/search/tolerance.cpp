#include <batten/search/tolerance.hpp>

#include <batten/search/search.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

std::vector<double> sample_tolerances(const Samples& samples, const ToleranceOptions& options) {
    std::vector<double> t = options.per_sample;
    if (t.empty()) t.assign(static_cast<std::size_t>(samples.size()), options.value);
    if (static_cast<Index>(t.size()) != samples.size())
        throw InvalidInput(
            fmt::format("tolerances: {} given for {} samples; one per sample is needed", t.size(),
                        samples.size()));
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(t[i] > 0) || !std::isfinite(t[i]))
            throw InvalidInput(
                options.per_sample.empty()
                    ? fmt::format("tolerance {} must be positive and finite", t[i])
                    : fmt::format("tolerance {}: {} must be positive and finite", i, t[i]));
    return t;
}

FitResult fit_to_tolerance(const Samples& samples, const FitOptions& options) {
    const std::vector<double> tolerance = sample_tolerances(samples, options.tolerance);
    if (options.smooth.wanted)
        throw InvalidInput("tolerance and smoothing: one of them rules how close the spline is; "
                           "state one");
    if (!options.shape.knots.empty())
        throw InvalidInput("tolerance: knots are found by the fit and cannot be given, too");
    if (options.method.name != "auto")
        throw InvalidInput(fmt::format("tolerance: the method is the search's own, got {}; epia "
                                       "has its own (--stop-deviation)",
                                       options.method.name));
    const bool cloud = options.shape.parameters && options.shape.parameters->is_scattered();
    return samples.grid.empty() && !cloud ? curve_within(samples, options, tolerance)
                                          : surface_within(samples, options, tolerance);
}

} // namespace batten
