#include <batten/parametrize/noise_aware.hpp>

#include <batten/samples/noise.hpp>

#include <algorithm>

namespace batten {

std::vector<double> noise_aware_parameters(const Points& q, Closure closure) {
    const Index m = q.size();
    const bool closed = closure == Closure::closed;
    const Index apart = std::clamp<Index>(m / 20, 1, 16);
    std::vector<double> steps; // over several samples: the noise adds less
    for (Index i = 0; i + apart < m; ++i)
        steps.push_back(distance(q[i], q[i + apart]) / static_cast<double>(apart));
    const double step = median(std::move(steps));
    // means of w samples have steps with noise of sqrt(2) sigma / w: a tenth of the step is little
    const double wanted = step > 0 ? 14 * usual_noise(q) / step : 0;
    const auto half = static_cast<Index>(std::min(wanted / 2, static_cast<double>(m) / 20));
    if (half < 1) return parametrize_sequence(q, Parametrization::chord, closure);
    PointSet means(m, q.dim());
    for (Index i = 0; i < m; ++i) {
        const Index reach = closed ? half : std::min({half, i, m - 1 - i});
        for (Index j = i - reach; j <= i + reach; ++j)
            for (Index d = 0; d < q.dim(); ++d)
                means(i, d) += q((j % m + m) % m, d) / static_cast<double>(2 * reach + 1);
    }
    return parametrize_sequence(means, Parametrization::chord, closure);
}

} // namespace batten
