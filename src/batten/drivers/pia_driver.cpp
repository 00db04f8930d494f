#include <batten/drivers/pia_driver.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/least_squares.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/problem/plan.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace batten {

namespace {

/// Everything that a PIA needs besides the samples.
struct Setting {
    Parameters parameters;
    std::vector<KnotVector> axes;
    /// Per axis and control point the sample that it starts from and follows.
    std::vector<std::vector<Index>> own;
};

/// Accumulated chords along an axis, averaged over the rows of a grid, not normalised: eq. 1, 12
/// and 13.
std::vector<double> accumulated_chords(const Samples& samples, std::size_t axis) {
    const std::vector<Index> shape = samples.shape();
    const Index count = shape[axis];
    Index inner = 1;
    for (std::size_t k = axis + 1; k < shape.size(); ++k) inner *= shape[k];
    const Index rows = samples.size() / count;
    std::vector<double> t(static_cast<std::size_t>(count));
    for (Index j = 1; j < count; ++j) {
        double sum = 0;
        for (Index row = 0; row < rows; ++row) {
            const Index at = row / inner * count * inner + row % inner + j * inner;
            sum += distance(samples.points[at], samples.points[at - inner]);
        }
        t[static_cast<std::size_t>(j)] =
            t[static_cast<std::size_t>(j - 1)] + sum / static_cast<double>(rows);
        if (!(sum > 0))
            throw InvalidInput(fmt::format(
                "axis {}: samples {} and {} are identical; PIA needs distinct neighbours", axis,
                j - 1, j));
    }
    return t;
}

Setting setting_of_2004(const Samples& samples) {
    Setting setting;
    const std::vector<Index> shape = samples.shape();
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
        const Index m = shape[axis];
        if (m < 3)
            throw InvalidInput(
                fmt::format("axis {}: PIA needs at least 3 samples, got {}", axis, m));
        const std::vector<double> t = accumulated_chords(samples, axis);
        setting.axes.push_back(
            knots_around(3, std::span(t).subspan(1, t.size() - 2), t.front(), t.back()));
        setting.parameters.axes.push_back(t);
        std::vector<Index> own;
        for (Index i = 0; i < m + 2; ++i) own.push_back(std::clamp<Index>(i - 1, 0, m - 1));
        setting.own.push_back(std::move(own));
    }
    return setting;
}

/// As many control points as samples want knots of their own, where eq. 9.69 would leave the
/// collocation matrix near-singular.
KnotVector interpolating(const KnotVector& chosen, const std::vector<double>& parameters) {
    return chosen.closed() ? knots_at_parameters(parameters, chosen.degree())
                           : averaged_knots(parameters, chosen.degree());
}

/// The sample that each control point of a closed axis follows: in the same order round, from the
/// one that leaves samples nearest to the middles of the B-splines.
std::vector<Index> samples_round(const KnotVector& axis, const std::vector<double>& parameters) {
    const auto n = static_cast<Index>(parameters.size());
    const int p = axis.degree();
    const auto apart = [&](Index i, Index j) { // B-spline i and sample j
        double middle = 0;
        for (int k = 1; k <= p; ++k) middle += axis[i + k] / p;
        const double turns = (middle - parameters[static_cast<std::size_t>(j)]) / axis.length();
        return std::abs(turns - std::round(turns));
    };
    Index nearest = 0;
    for (Index j = 1; j < n; ++j)
        if (apart(0, j) < apart(0, nearest)) nearest = j;
    Index best = nearest;
    double smallest = std::numeric_limits<double>::infinity();
    for (Index first = nearest - p; first <= nearest + p; ++first) {
        double sum = 0;
        for (Index i = 0; i < n; ++i) sum += apart(i, (i + first + n) % n);
        if (sum < smallest) {
            smallest = sum;
            best = first;
        }
    }
    std::vector<Index> own;
    for (Index i = 0; i < n; ++i) own.push_back((i + best + n) % n);
    return own;
}

std::vector<Index> in_order(Index count) {
    std::vector<Index> own(static_cast<std::size_t>(count));
    std::iota(own.begin(), own.end(), Index{0});
    return own;
}

Setting square_setting(const Samples& samples, const FitOptions& options) {
    Setting setting;
    const AxisPlan plan = plan_axes(samples, options.shape);
    setting.parameters = choose_parameters(samples, options.shape, plan);
    if (setting.parameters.is_scattered())
        throw InvalidInput(
            "pia: samples in order or a grid are needed, not a cloud; use epia or lspia");
    setting.axes = choose_knots(setting.parameters, options.shape, plan);
    const bool free_knots =
        options.shape.knots.empty() && options.shape.placement == KnotPlacement::data;
    for (std::size_t axis = 0; axis < setting.axes.size(); ++axis) {
        KnotVector& knots = setting.axes[axis];
        const std::vector<double>& t = setting.parameters.axes[axis];
        const auto m = static_cast<Index>(t.size());
        if (knots.free_count() != m)
            throw InvalidInput(
                fmt::format("axis {}: pia needs as many control points as samples, got {} and {}",
                            axis, knots.free_count(), m));
        if (free_knots) knots = interpolating(knots, t);
        if (const auto gap = undetermined(knots, t))
            throw InvalidInput(
                fmt::format("axis {}: the collocation matrix is singular: {}", axis, *gap));
        setting.own.push_back(knots.closed() ? samples_round(knots, t) : in_order(m));
    }
    return setting;
}

SampleGroups single_samples(const Setting& setting, const std::vector<Index>& shape) {
    std::vector<std::vector<SampleRange>> ranges;
    for (const auto& own : setting.own) {
        ranges.emplace_back();
        for (Index j : own) ranges.back().push_back({j, j + 1});
    }
    return {std::move(ranges), shape};
}

/// P^0: every control point at its own sample.
PointSet own_samples(const SampleGroups& groups, const Samples& samples) {
    return groups.means(PointSet(samples.points));
}

} // namespace

FitResult fit_pia(const Samples& samples, const FitOptions& options) {
    FitResult result;
    Stopwatch watch;
    const ShapeOptions& shape = options.shape;
    if (!options.hold.interpolate.empty())
        throw InvalidInput("pia interpolates every sample already");
    const bool stated = !shape.control_points.empty() || !shape.knots.empty();
    if (!stated && (shape.degree != std::vector<int>{3} ||
                    shape.closures != std::vector<Closure>{Closure::open}))
        throw InvalidInput("pia: without stated knots or control points it is cubic and open");
    Setting setting = stated ? square_setting(samples, options) : setting_of_2004(samples);
    result.parameters = std::move(setting.parameters);
    const DataSide data(setting.axes, samples, result.parameters,
                        single_samples(setting, samples.shape()));
    result.report.method = "pia";
    result.report.seconds.emplace_back("parametrize", watch.lap());
    PointSet control =
        options.method.initial == Initial::data
            ? own_samples(data.groups(), samples)
            : initial_control(samples, result.parameters, setting.axes, options.method);
    const MethodEntry& entry = method_entry("pia");
    check_settings(entry, options.method.settings);
    Pia pia(data, batten::setting(entry, options.method.settings, "weight"), options.method.moving);
    run(
        pia, control, options, setting.axes,
        [&](const PointSet& at) { return largest_length(data.residual(at)); }, result.report);
    result.report.seconds.emplace_back("solve", watch.lap());
    result.spline = Spline::from_free(setting.axes, control);
    return result;
}

} // namespace batten
