#include <batten/search/residual_noise.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/vectors.hpp>
#include <batten/parametrize/noise_aware.hpp>
#include <batten/samples/samples.hpp>
#include <batten/solve/direct.hpp>
#include <batten/system/factored_system.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace batten {

namespace {

constexpr int degree = 3;
/// A curve with too little freedom crosses its samples at most degree + 1 times per span: with this
/// many samples to a span that is told from the crossings of chance, every second sample.
constexpr Index samples_per_span = 16;
constexpr double rounding = 1e-9; ///< part of the samples' size: less is no noise

/// Without what lies along the curve: no residuals, for a line of numbers.
PointSet across(const Spline& curve, const Points& at, const PointSet& residuals) {
    if (residuals.dim() == 1) return {};
    PointSet result = residuals;
    const PointSet tangents = evaluate(curve, at, std::array{1});
    for (Index i = 0; i < result.size(); ++i) {
        const double square = dot(tangents[i], tangents[i]);
        if (!(square > 0)) continue;
        const double along = dot(result[i], tangents[i]) / square;
        for (Index d = 0; d < result.dim(); ++d) result(i, d) -= along * tangents(i, d);
    }
    return result;
}

/// What the least-squares curve with so many spans leaves of each sample (m x dim). Along a curve
/// uneven distances look like noise; of noise, whatever its direction, a good part is across it: in
/// a smaller one all of its noise shows, as large in every direction.
PointSet residuals(const Points& q, const std::vector<double>& t, Index spans) {
    constexpr double good_part = 0.5;
    const KnotVector knots = knots_from_parameters(t, degree, spans + degree);
    BandedSystem system(knots, {q[0].begin(), q[0].end()});
    system.add(t, q, {});
    const Spline curve =
        Spline::from_free({knots}, uncentred(solve_direct(system), system.centre()));
    const Points at(t.data(), q.size(), 1);
    PointSet left = evaluate(curve, at);
    for (Index i = 0; i < q.size(); ++i)
        for (Index d = 0; d < q.dim(); ++d) left(i, d) = q(i, d) - left(i, d);
    PointSet part = across(curve, at, left);
    if (part.empty()) return left;
    const auto dim = static_cast<double>(q.dim());
    for (double& x : part.values()) x *= std::sqrt(dim / (dim - 1));
    return frobenius_norm(part) < good_part * frobenius_norm(left) ? part : left;
}

/// Whether residuals turn to the other side from one sample to the next as often as independent
/// ones, to two standard deviations, and are no more alike than these, to one and a half: few
/// samples of a smooth curve turn often enough by themselves.
bool independent(const PointSet& r) {
    double turns = 0;
    double alike = 0;
    double square = 0;
    for (Index i = 0; i + 1 < r.size(); ++i) {
        const double product = dot(r[i], r[i + 1]);
        if (product < 0) ++turns;
        alike += product;
        square += dot(r[i], r[i]);
    }
    const auto steps = static_cast<double>(r.size() - 1);
    return turns >= steps / 2 - std::sqrt(steps) && alike <= 1.5 * square / std::sqrt(steps);
}

/// Of very many samples evenly some, which tell the noise to half a percent; each place once, as
/// repeated samples tell nothing.
PointSet enough(const Points& q) {
    constexpr Index most = 1 << 16;
    const Index stride = (q.size() + most - 1) / most;
    std::vector<double> some;
    for (Index i = 0; i < q.size(); i += stride)
        if (i == 0 || !std::ranges::equal(q[i], q[i - stride]))
            some.insert(some.end(), q[i].begin(), q[i].end());
    return {std::move(some), q.dim()};
}

} // namespace

double residual_noise(const Points& all) {
    const PointSet some = enough(all);
    const Points q(some);
    const Index m = q.size();
    if (m < samples_per_span) return 0;
    if (!(diagonal(q) > 0)) return 0;
    const std::vector<double> t = noise_aware_parameters(q, Closure::open);
    for (Index spans = 1; spans * samples_per_span <= m; spans *= 2) {
        try {
            const PointSet left = residuals(q, t, spans);
            if (!independent(left)) continue;
            const double noise =
                frobenius_norm(left) / std::sqrt(static_cast<double>(m - spans - degree));
            return noise > rounding * diagonal(q) ? noise : 0;
        } catch (const SolverError&) { // samples crowd at one side of a span
            return 0;
        }
    }
    return 0;
}

} // namespace batten
