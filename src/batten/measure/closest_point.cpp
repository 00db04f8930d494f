#include <batten/measure/deviation.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

/// A spline's points over a grid of parameters, a few per polynomial piece and axis.
struct Net {
    std::vector<std::vector<double>> parameters;
    PointSet points;
};

Net coarse_net(const Spline& spline) {
    Net net;
    for (const KnotVector& knots : spline.axes()) {
        const int per_piece = knots.degree() + 1;
        const std::vector<double> breaks = knots.breakpoints();
        std::vector<double> t;
        for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
            for (int s = 0; s < per_piece; ++s)
                t.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * s / per_piece);
        t.push_back(breaks.back());
        net.parameters.push_back(std::move(t));
    }
    net.points = evaluate_grid(spline, net.parameters);
    return net;
}

std::vector<double> net_parameter(const Net& net, Index at) {
    std::vector<double> t(net.parameters.size());
    for (std::size_t a = t.size(); a-- > 0;) {
        const auto m = static_cast<Index>(net.parameters[a].size());
        t[a] = net.parameters[a][static_cast<std::size_t>(at % m)];
        at /= m;
    }
    return t;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t d = 0; d < a.size(); ++d) sum += a[d] * b[d];
    return sum;
}

std::vector<double> difference(const std::vector<double>& a, std::span<const double> b) {
    std::vector<double> r(a.size());
    for (std::size_t d = 0; d < a.size(); ++d) r[d] = a[d] - b[d];
    return r;
}

/// Keeps a parameter inside the domain: around the end of a closed axis, at the end of an open one.
double confined(const KnotVector& knots, double t) {
    return knots.closed() ? knots.wrapped(t) : std::clamp(t, knots.begin(), knots.end());
}

/// The Newton step of the squared distance for 1 or 2 axes; Gauss-Newton where the Hessian is not
/// positive.
std::vector<double> newton_step(const Spline& spline, const std::vector<double>& t,
                                const std::vector<double>& r) {
    const std::size_t axes = t.size();
    if (axes == 1) {
        const auto d1 = spline(t, std::array{1});
        const auto d2 = spline(t, std::array{2});
        const double slope = dot(r, d1);
        double curvature = dot(d1, d1) + dot(r, d2);
        if (!(curvature > 0)) curvature = dot(d1, d1);
        return {curvature > 0 ? -slope / curvature : 0.0};
    }
    const auto du = spline(t, std::array{1, 0});
    const auto dv = spline(t, std::array{0, 1});
    const double gu = dot(r, du);
    const double gv = dot(r, dv);
    double a = dot(du, du) + dot(r, spline(t, std::array{2, 0}));
    double b = dot(du, dv) + dot(r, spline(t, std::array{1, 1}));
    double c = dot(dv, dv) + dot(r, spline(t, std::array{0, 2}));
    if (!(a > 0 && a * c - b * b > 0)) {
        a = dot(du, du);
        b = dot(du, dv);
        c = dot(dv, dv);
        const double damping = 1e-12 * (a + c);
        a += damping;
        c += damping;
    }
    const double determinant = a * c - b * b;
    if (!(determinant > 0)) return {0.0, 0.0};
    return {(-c * gu + b * gv) / determinant, (b * gu - a * gv) / determinant};
}

ClosestPoint refine(const Spline& spline, std::vector<double> t, std::span<const double> point) {
    std::vector<double> r = difference(spline(t), point);
    double best = dot(r, r);
    for (int iteration = 0; iteration < 30; ++iteration) {
        std::vector<double> step = newton_step(spline, t, r);
        bool better = false;
        for (int halving = 0; halving < 12 && !better; ++halving) {
            std::vector<double> next(t.size());
            for (std::size_t a = 0; a < t.size(); ++a)
                next[a] = confined(spline.axes()[a], t[a] + step[a]);
            const std::vector<double> trial = difference(spline(next), point);
            const double value = dot(trial, trial);
            if (value < best) {
                better = true;
                best = value;
                t = std::move(next);
                r = trial;
            }
            for (double& s : step) s /= 2;
        }
        if (!better) break;
    }
    return {std::move(t), std::sqrt(best)};
}

/// Places of the net's neighbours of place `at`, along every axis.
void neighbours(const Net& net, Index at, std::vector<Index>& out) {
    out.clear();
    Index stride = 1;
    for (std::size_t a = net.parameters.size(); a-- > 0;) {
        const auto m = static_cast<Index>(net.parameters[a].size());
        const Index here = at / stride % m;
        if (here > 0) out.push_back(at - stride);
        if (here + 1 < m) out.push_back(at + stride);
        stride *= m;
    }
}

ClosestPoint closest(const Spline& spline, const Net& net, std::span<const double> point) {
    // every place that is nearer than its neighbours may lead to another branch: the nearest start
    // first, as long as what lies between them and their neighbours could still be nearer
    constexpr std::size_t most_starts = 24;
    std::vector<double> away(static_cast<std::size_t>(net.points.size()));
    for (Index k = 0; k < net.points.size(); ++k)
        away[static_cast<std::size_t>(k)] = distance(net.points[k], point);
    const auto distance_of = [&](Index k) { return away[static_cast<std::size_t>(k)]; };
    struct Start {
        double least; ///< distance that a place near it may have
        Index place;
    };
    std::vector<Start> starts;
    std::vector<Index> near;
    for (Index k = 0; k < net.points.size(); ++k) {
        neighbours(net, k, near);
        double reach = 0;
        bool lowest = true;
        for (Index n : near) {
            lowest = lowest && distance_of(k) <= distance_of(n);
            reach = std::max(reach, distance(net.points[k], net.points[n]));
        }
        if (lowest) starts.push_back({distance_of(k) - reach, k});
    }
    std::ranges::sort(starts, {}, [&](const Start& start) { return distance_of(start.place); });
    ClosestPoint best{{}, std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < std::min(starts.size(), most_starts); ++k) {
        if (k >= 4 && starts[k].least > best.distance) continue;
        ClosestPoint found = refine(spline, net_parameter(net, starts[k].place), point);
        if (found.distance < best.distance) best = std::move(found);
    }
    return best;
}

} // namespace

std::vector<ClosestPoint> closest_points(const Spline& spline, const Points& points) {
    if (points.dim() != spline.dim())
        throw InvalidInput(fmt::format("the points have dimension {}, the spline has {}",
                                       points.dim(), spline.dim()));
    if (spline.axis_count() > 2)
        throw InvalidInput(
            "closest points on a volume: a point inside has distance 0; compare at parameters");
    const Net net = coarse_net(spline);
    std::vector<ClosestPoint> result(static_cast<std::size_t>(points.size()));
    for_each_chunk(points.size(), [&](Index i) {
        result[static_cast<std::size_t>(i)] = closest(spline, net, points[i]);
    });
    return result;
}

} // namespace batten
