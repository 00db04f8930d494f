#include <batten/problem/initial.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/spline/spline.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

/// Index of the sample that starts control point i of n on an axis of m samples.
Index start_sample(const KnotVector& knots, const std::vector<double>& t, Index i) {
    const Index n = knots.free_count();
    const auto m = static_cast<Index>(t.size());
    if (!knots.closed()) // [HuangWang2020, eq. 38], whose last line has n for m
        return i == n - 1 ? m - 1 : m * i / (n - 1);
    double greville = 0;
    for (Index k = i + 1; k <= i + knots.degree(); ++k) greville += knots[k] / knots.degree();
    const double at = knots.wrapped(greville);
    const auto after = std::ranges::lower_bound(t, at) - t.begin();
    if (after == m) return m - 1;
    return after > 0 && at - t[static_cast<std::size_t>(after - 1)] <
                            t[static_cast<std::size_t>(after)] - at
               ? after - 1
               : after;
}

/// Index of the value nearest to t in ascending values.
Index nearest(const std::vector<double>& values, double t) {
    const auto after = std::ranges::lower_bound(values, t) - values.begin();
    if (after == static_cast<Index>(values.size())) return after - 1;
    if (after == 0) return 0;
    return t - values[static_cast<std::size_t>(after - 1)] <
                   values[static_cast<std::size_t>(after)] - t
               ? after - 1
               : after;
}

/// Gives control points without a sample of their own (-1) their nearest neighbour's, ring by ring
/// along the axes.
void fill_holes(std::vector<Index>& sample, const GridIndex& net) {
    for (bool holes = true; holes;) {
        holes = false;
        const std::vector<Index> before = sample;
        net.for_each([&](const GridIndex::Place& place, Index i) {
            if (before[static_cast<std::size_t>(i)] >= 0) return;
            holes = true;
            for (std::size_t a = net.axis_count(); a-- > 0;)
                for (Index step : {-1, 1}) {
                    if (place[a] + step < 0 || place[a] + step >= net.length(a)) continue;
                    const Index other = before[static_cast<std::size_t>(i + step * net.stride(a))];
                    if (other >= 0) sample[static_cast<std::size_t>(i)] = other;
                }
        });
    }
}

/// Greville abscissae of the free control points, ascending per axis.
std::vector<std::vector<double>> free_greville(const std::vector<KnotVector>& axes) {
    std::vector<std::vector<double>> greville;
    for (const KnotVector& axis : axes) {
        greville.push_back(greville_abscissae(axis));
        greville.back().resize(static_cast<std::size_t>(axis.free_count()));
    }
    return greville;
}

/// The control point nearest to a sample in the parameters, and how far away.
struct Nearest {
    Index control;
    double away;
};

Nearest nearest_control(std::span<const double> parameter, const std::vector<KnotVector>& axes,
                        const std::vector<std::vector<double>>& greville) {
    Nearest result{0, 0};
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const double t = axes[a].wrapped(parameter[a]);
        const Index at = nearest(greville[a], t);
        result.control = result.control * axes[a].free_count() + at;
        result.away += std::abs(t - greville[a][static_cast<std::size_t>(at)]) / axes[a].length();
    }
    return result;
}

/// The control point nearest to a sample or, where it is taken, the nearest of its neighbours that
/// is free; `control` -1 where none is.
Nearest nearest_free(std::span<const double> parameter, const std::vector<KnotVector>& axes,
                     const std::vector<std::vector<double>>& greville,
                     const std::vector<bool>& taken) {
    const Nearest own = nearest_control(parameter, axes, greville);
    if (!taken[static_cast<std::size_t>(own.control)]) return own;
    const GridIndex net(free_shape(axes));
    const GridIndex::Place middle = net.place(own.control);
    Nearest best{-1, std::numeric_limits<double>::infinity()};
    GridIndex(std::vector<Index>(axes.size(), 3))
        .for_each([&](const GridIndex::Place& step, Index) {
            GridIndex::Place place = middle;
            double away = 0;
            for (std::size_t a = 0; a < axes.size(); ++a) {
                place[a] += step[a] - 1;
                if (place[a] < 0 || place[a] >= net.length(a)) return;
                away += std::abs(axes[a].wrapped(parameter[a]) -
                                 greville[a][static_cast<std::size_t>(place[a])]) /
                        axes[a].length();
            }
            const Index at = net.at(place);
            if (!taken[static_cast<std::size_t>(at)] && away < best.away) best = {at, away};
        });
    return best;
}

/// The samples in the groups, and the nearest of each control point's own, -1 of none.
struct Nearness {
    std::vector<GroupMember> members;
    std::vector<Index> sample;
};

Nearness nearness(const Parameters& parameters, const std::vector<KnotVector>& axes,
                  const std::vector<Index>& alone) {
    const auto greville = free_greville(axes);
    const auto total = static_cast<std::size_t>(GridIndex(free_shape(axes)).size());
    std::vector<bool> taken(total);
    std::vector<double> closest(total, std::numeric_limits<double>::infinity());
    Nearness result{{}, std::vector<Index>(total, -1)};
    const auto enter = [&](Index j) {
        const Nearest own = nearest_free(parameters.scattered[j], axes, greville, taken);
        if (own.control < 0) return own.control;
        const auto at = static_cast<std::size_t>(own.control);
        result.members.push_back({own.control, j});
        if (own.away < closest[at]) result.sample[at] = j;
        closest[at] = std::min(closest[at], own.away);
        return own.control;
    };
    std::vector<bool> entered(static_cast<std::size_t>(parameters.scattered.size()));
    for (Index j : alone) {
        entered[static_cast<std::size_t>(j)] = true;
        const Index control = enter(j);
        if (control < 0)
            throw InvalidInput(fmt::format("sample {} finds no control point of its own to be "
                                           "interpolated by: more control points are needed",
                                           j));
        taken[static_cast<std::size_t>(control)] = true;
    }
    for (Index j = 0; j < parameters.scattered.size(); ++j)
        if (!entered[static_cast<std::size_t>(j)]) enter(j);
    return result;
}

/// The sample nearest in the parameters to each control point's Greville abscissae.
PointSet nearest_samples(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, PointSet control) {
    std::vector<Index> sample = nearness(parameters, axes, {}).sample;
    fill_holes(sample, GridIndex(free_shape(axes)));
    for (Index i = 0; i < control.size(); ++i)
        std::ranges::copy(samples.points[sample[static_cast<std::size_t>(i)]], control[i].begin());
    return control;
}

} // namespace

std::vector<GroupMember> nearest_groups(const Parameters& parameters,
                                        const std::vector<KnotVector>& axes,
                                        const std::vector<Index>& alone) {
    return nearness(parameters, axes, alone).members;
}

namespace {

/// Given control points, refined where they stand over fewer knots.
PointSet given_control(const PointSet& control, Index dim, const std::vector<KnotVector>& axes,
                       const MethodOptions& options) {
    const Index total = GridIndex(free_shape(axes)).size();
    const bool fits = control.size() == total && control.dim() == dim;
    if (fits) return control;
    const std::string given = fmt::format("initial control points: {} of dimension {} given",
                                          control.size(), control.dim());
    if (options.control_axes.size() != axes.size() || control.dim() != dim)
        throw InvalidInput(fmt::format("{}, {} of dimension {} needed", given, total, dim));
    Spline spline = Spline::from_free(options.control_axes, control);
    try {
        for (std::size_t a = 0; a < axes.size(); ++a)
            spline = refine(spline, static_cast<Index>(a), axes[a]);
    } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("{}, {} needed, whose knots do not contain theirs: {}",
                                       given, total, error.what()));
    }
    return spline.free_control_points();
}

} // namespace

PointSet moves_before(Index dim, const std::vector<KnotVector>& axes,
                      const MethodOptions& options) {
    PointSet moves = given_control(options.control, dim, axes, options);
    add_scaled(moves, -1, given_control(options.before, dim, axes, options));
    return moves;
}

PointSet initial_control(const Samples& samples, const Parameters& parameters,
                         const std::vector<KnotVector>& axes, const MethodOptions& options) {
    const GridIndex net(free_shape(axes));
    const Index total = net.size();
    if (options.initial == Initial::given)
        return given_control(options.control, samples.dim(), axes, options);
    PointSet control(total, samples.dim());
    if (options.initial == Initial::zero) return control;
    if (parameters.is_scattered())
        return nearest_samples(samples, parameters, axes, std::move(control));
    const GridIndex grid(samples.shape());
    net.for_each([&](const GridIndex::Place& place, Index k) {
        GridIndex::Place sample{};
        for (std::size_t a = 0; a < axes.size(); ++a)
            sample[a] = start_sample(axes[a], parameters.axes[a], place[a]);
        std::ranges::copy(samples.points[grid.at(sample)], control[k].begin());
    });
    return control;
}

} // namespace batten
