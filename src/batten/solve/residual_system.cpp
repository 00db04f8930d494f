#include <batten/solve/residual_system.hpp>

#include <batten/basis/active_functions.hpp>
#include <batten/core/vectors.hpp>

namespace batten {

std::unique_ptr<NormalSystem> residual_system(const Spline& spline,
                                              const std::vector<KnotVector>& axes,
                                              const Samples& samples,
                                              const Parameters& parameters) {
    PointSet points(samples.points);
    add_scaled(points, -1.0,
               evaluate(spline, parameters.is_scattered() ? Points(parameters.scattered)
                                                          : parameter_rows(parameters)));
    Samples rest = samples;
    rest.points = Points(std::move(points));
    return assemble(axes, rest, parameters);
}

Residuals residuals_of(const PointSet& control, const NormalSystem& system, const Samples& samples,
                       const Parameters& parameters) {
    constexpr Index blocks = 16; // each has control points of its own
    const Index m = samples.size();
    const Index dim = samples.dim();
    std::vector<Residuals> parts(blocks);
    for_each_block(m, m / blocks + 1, [&](const Block& block) {
        Residuals& part = parts[static_cast<std::size_t>(block.index)];
        part.pulls = PointSet(control.size(), dim);
        std::vector<double> rest(static_cast<std::size_t>(dim));
        for (Index i = block.begin; i < block.end; ++i) {
            const std::vector<double> at = parameter_of(parameters, i);
            const ActiveRow row(system.axes(), at, Numbering::free);
            for (Index d = 0; d < dim; ++d)
                rest[static_cast<std::size_t>(d)] =
                    samples.points(i, d) - system.centre()[static_cast<std::size_t>(d)];
            row.for_each_active([&](Index c, double value) {
                add_scaled(rest.data(), -value, control[c].data(), dim);
            });
            const double weight =
                samples.weights.empty() ? 1 : samples.weights[static_cast<std::size_t>(i)];
            part.squares += weight * dot(rest, rest);
            row.for_each_active([&](Index c, double value) {
                add_scaled(part.pulls[c].data(), weight * value, rest.data(), dim);
            });
        }
    });
    Residuals result{PointSet(control.size(), dim)};
    for (const Residuals& part : parts) { // in order: the same bits for any number of threads
        if (!part.pulls.empty()) add_scaled(result.pulls, 1, part.pulls);
        result.squares += part.squares;
    }
    return result;
}

} // namespace batten
