#include <batten/measure/between_samples.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace batten {

namespace {

/// Height of the arc over the chord b c on the circle through a, b, c (a beside b).
double sagitta(std::span<const double> a, std::span<const double> b, std::span<const double> c) {
    const double ab = distance(a, b);
    const double bc = distance(b, c);
    const double ca = distance(c, a);
    const double s = (ab + bc + ca) / 2;
    const double area = std::sqrt(std::max(0.0, s * (s - ab) * (s - bc) * (s - ca)));
    if (!(area > 0)) return 0;
    const double radius = ab * bc * ca / (4 * area);
    return radius - std::sqrt(std::max(0.0, radius * radius - bc * bc / 4));
}

double off_segment(std::span<const double> p, std::span<const double> a,
                   std::span<const double> b) {
    double along = 0;
    double length = 0;
    for (std::size_t d = 0; d < p.size(); ++d) {
        along += (p[d] - a[d]) * (b[d] - a[d]);
        length += (b[d] - a[d]) * (b[d] - a[d]);
    }
    const double part = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
    double square = 0;
    for (std::size_t d = 0; d < p.size(); ++d) {
        const double gap = p[d] - a[d] - part * (b[d] - a[d]);
        square += gap * gap;
    }
    return std::sqrt(square);
}

/// Whether the line of `count` steps from point `first` turns by more than three quarters of a full
/// turn.
bool turns_around(const PointSet& p, Index first, Index count) {
    double turned = 0;
    bool gentle = count <= 6; // turns of an eighth each do not make it
    for (Index k = first; k + 2 <= first + count; ++k) {
        const double ux = p(k + 1, 0) - p(k, 0);
        const double uy = p(k + 1, 1) - p(k, 1);
        const double vx = p(k + 2, 0) - p(k + 1, 0);
        const double vy = p(k + 2, 1) - p(k + 1, 1);
        const double sine = ux * vy - uy * vx;
        const double cosine = ux * vx + uy * vy;
        gentle = gentle && std::abs(sine) <= cosine;
        if (!gentle) turned += std::atan2(sine, cosine);
    }
    return std::abs(turned) > 1.5 * std::numbers::pi;
}

constexpr double loop_excess = 2;
constexpr Index steps = 5; // from a sample to the next
constexpr Index pairs_at_once = 1 << 14;

/// Samples in order with a curve's parameters and tolerances, and what it does between them.
struct Run {
    const Spline& curve;
    const Points& q;
    const std::vector<double>& parameters;
    const std::vector<double>& tolerance;

    bool closed() const { return curve.axis(0).closed(); }
    Index pairs() const { return closed() ? q.size() : q.size() - 1; }

    /// Parameter of sample `i`, of a closed curve's first one turn later, too.
    double parameter(Index i) const {
        return i < q.size() ? parameters[static_cast<std::size_t>(i)]
                            : parameters[0] + curve.axis(0).length();
    }

    /// The line of points between the samples [begin, end], `steps` to a pair.
    PointSet line(Index begin, Index end) const {
        PointSet at((end - begin) * steps + 1, 1);
        for (Index k = 0; k + 1 < at.size(); ++k) {
            const double from = parameter(begin + k / steps);
            const double to = parameter(begin + k / steps + 1);
            at(k, 0) = from + (to - from) * static_cast<double>(k % steps) / steps;
        }
        at(at.size() - 1, 0) = parameter(end);
        return evaluate(curve, at);
    }

    /// What the line does from point `first` on between sample i and the next.
    void check(const PointSet& line, Index first, Index i, BetweenSamples& result) const {
        const Index m = q.size();
        const Index j = (i + 1) % m;
        const double t = std::max(tolerance[static_cast<std::size_t>(i)],
                                  tolerance[static_cast<std::size_t>(j)]);
        double arc = 0;
        if (closed() || i > 0) arc = std::max(arc, sagitta(q[(i + m - 1) % m], q[i], q[j]));
        if (closed() || i + 2 < m) arc = std::max(arc, sagitta(q[(j + 1) % m], q[j], q[i]));
        const double allowed = std::max(2 * t, arc + t);
        double stray = 0;
        double length = 0;
        for (Index k = first; k < first + steps; ++k) {
            stray = std::max(stray, off_segment(line[k], q[i], q[j]));
            length += distance(line[k], line[k + 1]);
        }
        double excess =
            std::max(stray / allowed, length / (1.2 * distance(q[i], q[j]) + 4 * t + 2 * arc));
        if (q.dim() == 2 && turns_around(line, first, steps)) {
            ++result.loops;
            excess = std::max(excess, loop_excess);
        }
        if (excess > result.excess) {
            result.excess = excess;
            result.worst_sample = i;
        }
    }
};

} // namespace

BetweenSamples check_between(const Spline& curve, const Points& q,
                             const std::vector<double>& parameters,
                             const std::vector<double>& tolerance) {
    const Run run{curve, q, parameters, tolerance};
    std::vector<BetweenSamples> parts(
        static_cast<std::size_t>(block_count(run.pairs(), pairs_at_once)));
    for_each_block(run.pairs(), pairs_at_once, [&](const Block& block) {
        const PointSet line = run.line(block.begin, block.end);
        for (Index i = block.begin; i < block.end; ++i)
            run.check(line, (i - block.begin) * steps, i,
                      parts[static_cast<std::size_t>(block.index)]);
    });
    BetweenSamples result;
    for (const BetweenSamples& part : parts) {
        result.loops += part.loops;
        if (!(part.excess > result.excess)) continue;
        result.excess = part.excess;
        result.worst_sample = part.worst_sample;
    }
    result.good = result.excess <= 1;
    return result;
}

} // namespace batten
