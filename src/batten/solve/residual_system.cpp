#include <batten/solve/residual_system.hpp>

namespace batten {

std::unique_ptr<NormalSystem> residual_system(const Spline& spline,
                                              const std::vector<KnotVector>& axes,
                                              const Samples& samples,
                                              const Parameters& parameters) {
    PointSet points(samples.points);
    for_each_block(points.size(), 1 << 12, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            const std::vector<double> at = spline(parameter_of(parameters, i));
            for (Index d = 0; d < points.dim(); ++d)
                points(i, d) -= at[static_cast<std::size_t>(d)];
        }
    });
    Samples rest = samples;
    rest.points = Points(std::move(points));
    return assemble(axes, rest, parameters);
}

} // namespace batten
