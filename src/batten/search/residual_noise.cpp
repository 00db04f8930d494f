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
/// Of fewer samples the parameters can follow the curve so far that hardly anything is left across
/// it.
constexpr Index fewest_across = 8 * samples_per_span;
constexpr double rounding = 1e-9; ///< part of the samples' size: less is no noise

/// Knots of spans of at least a length, with samples_per_span samples or more in each.
KnotVector knots_apart(const std::vector<double>& t, double length) {
    constexpr auto enough = static_cast<std::size_t>(samples_per_span);
    std::vector<double> interior;
    double from = t.front();
    std::size_t first = 0;
    for (std::size_t i = enough; i + enough <= t.size(); ++i) {
        const double at = (t[i - 1] + t[i]) / 2;
        if (i - first < enough || !(at > from && at < t.back()) || at - from < length) continue;
        interior.push_back(at);
        from = at;
        first = i;
    }
    return knots_around(degree, interior, t.front(), t.back());
}

/// Knots of ever shorter spans, the last as short as samples_per_span allows.
std::vector<KnotVector> ever_finer(const std::vector<double>& t) {
    const KnotVector finest = knots_apart(t, 0);
    std::vector<KnotVector> result;
    const auto most = static_cast<double>(t.size()) / static_cast<double>(samples_per_span);
    for (double parts = 1; 2 * parts <= most; parts *= 2) {
        KnotVector knots = knots_apart(t, (t.back() - t.front()) / parts);
        if (result.empty() || knots.free_count() > result.back().free_count())
            result.push_back(std::move(knots));
    }
    if (result.empty() || finest.free_count() > result.back().free_count())
        result.push_back(finest);
    return result;
}

/// The least-squares curve on these knots for samples at parameters in any order.
Spline least_squares(const KnotVector& knots, const Points& q, const std::vector<double>& t) {
    std::vector<std::size_t> order(t.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return t[i]; });
    std::vector<double> ascending;
    PointSet points(q.size(), q.dim());
    for (std::size_t i = 0; i < order.size(); ++i) {
        ascending.push_back(t[order[i]]);
        std::ranges::copy(q[static_cast<Index>(order[i])], points[static_cast<Index>(i)].begin());
    }
    BandedSystem system(knots, {q[0].begin(), q[0].end()});
    system.add(ascending, points, {});
    return Spline::from_free({knots}, uncentred(solve_direct(system), system.centre()));
}

PointSet residuals(const Spline& curve, const Points& q, const std::vector<double>& t) {
    PointSet left = evaluate(curve, Points(t.data(), q.size(), 1));
    for (Index i = 0; i < q.size(); ++i)
        for (Index d = 0; d < q.dim(); ++d) left(i, d) = q(i, d) - left(i, d);
    return left;
}

/// How far each residual reaches along the curve, in its parameter.
std::vector<double> along(const PointSet& left, const PointSet& tangents) {
    std::vector<double> result;
    for (Index i = 0; i < left.size(); ++i) {
        const double square = dot(tangents[i], tangents[i]);
        result.push_back(square > 0 ? dot(left[i], tangents[i]) / square : 0);
    }
    return result;
}

/// What the least-squares curve leaves of each sample (m x dim).
struct Residuals {
    PointSet whole;
    /// Across the curve, whose samples' parameters follow it, times what makes it as large as the
    /// whole of noise without a direction; no rows for a line of numbers.
    PointSet across;
    /// Whether most of the whole lies along the curve: uneven distances look like noise there.
    bool uneven = false;
};

Residuals whole_and_across(const KnotVector& knots, const Points& q, std::vector<double> t) {
    constexpr int rounds = 3;
    Residuals result;
    for (int round = 0; round < rounds; ++round) {
        const Spline curve = least_squares(knots, q, t);
        PointSet left = residuals(curve, q, t);
        if (round == 0) result.whole = left;
        if (q.dim() == 1) return result;
        const PointSet tangents = evaluate(curve, Points(t.data(), q.size(), 1), std::array{1});
        const std::vector<double> steps = along(left, tangents);
        for (std::size_t i = 0; i < t.size(); ++i) {
            const auto row = static_cast<Index>(i);
            for (Index d = 0; d < q.dim(); ++d) left(row, d) -= steps[i] * tangents(row, d);
            t[i] = std::clamp(t[i] + steps[i], curve.axis(0).begin(), curve.axis(0).end());
        }
        result.across = std::move(left);
    }
    const auto dim = static_cast<double>(q.dim());
    scale(result.across.values(), std::sqrt(dim / (dim - 1)));
    result.uneven = 2 * frobenius_norm(result.across) < frobenius_norm(result.whole);
    return result;
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
PointSet some_of(const Points& q) {
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
    const PointSet some = some_of(all);
    const Points q(some);
    const Index m = q.size();
    if (m < 4 * samples_per_span) return 0;
    if (!(diagonal(q) > 0)) return 0;
    // along a line of numbers, which goes back and forth, there is no curve to follow
    const std::vector<double> t = q.dim() == 1 ? parametrize_sequence(q, Parametrization::uniform)
                                               : noise_aware_parameters(q, Closure::open);
    const auto level = [&](const PointSet& left, Index controls) {
        const double noise = frobenius_norm(left) / std::sqrt(static_cast<double>(m - controls));
        return noise > rounding * diagonal(q) ? noise : 0;
    };
    double across = 0; // what counts where the parameters spoil what lies along the curve
    for (const KnotVector& knots : ever_finer(t)) {
        try {
            const Residuals left = whole_and_across(knots, q, t);
            const Index controls = knots.free_count();
            if (!left.uneven && independent(left.whole)) return level(left.whole, controls);
            if (m >= fewest_across && across == 0 && independent(left.across))
                across = level(left.across, controls);
        } catch (const SolverError&) { // samples crowd at one side of a span
            break;
        }
    }
    return across;
}

} // namespace batten
