#include <batten/drivers/pia_driver.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/grid_index.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/problem/initial.hpp>
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
    const GridIndex grid(samples.shape());
    const Index count = grid.length(axis);
    const double rows = static_cast<double>(grid.size() / count);
    std::vector<double> t(static_cast<std::size_t>(count));
    grid.for_each_strand(axis, [&](const GridIndex::Strand& row) {
        for (Index j = 1; j < count; ++j)
            t[static_cast<std::size_t>(j)] +=
                distance(samples.points[row[j]], samples.points[row[j - 1]]);
    });
    for (std::size_t j = 1; j < t.size(); ++j) {
        if (!(t[j] > 0))
            throw InvalidInput(fmt::format(
                "axis {}: samples {} and {} are identical; PIA needs distinct neighbours", axis,
                j - 1, j));
        t[j] = t[j - 1] + t[j] / rows;
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

/// Whether nothing is said of the space, so that it is the paper's own.
bool is_setting_of_2004(const Problem& problem) {
    const ShapeOptions& shape = problem.options.shape;
    const auto cubic = [](int degree) { return degree == 3; };
    const auto open = [](Closure closure) { return closure == Closure::open; };
    return !problem.sized() && !shape.parameters && !shape.parametrization && !shape.placement &&
           std::ranges::all_of(problem.axes.degree, cubic) &&
           std::ranges::all_of(problem.axes.closures, open);
}

/// As many control points as samples: knots by averaging, where eq. 9.69 would leave the
/// collocation matrix near-singular, unless a rule or knots are stated.
Setting square_setting(Problem problem) {
    if (!problem.sized()) problem.axes.control_points = problem.samples.shape();
    Setting setting{problem.parameters, fixed_knots(problem), {}};
    const ShapeOptions& shape = problem.options.shape;
    for (std::size_t axis = 0; axis < setting.axes.size(); ++axis) {
        KnotVector& knots = setting.axes[axis];
        const std::vector<double>& t = setting.parameters.axes[axis];
        const auto m = static_cast<Index>(t.size());
        if (knots.free_count() != m)
            throw InvalidInput(
                fmt::format("axis {}: pia needs as many control points as samples, got {} and {}",
                            axis, knots.free_count(), m));
        if (shape.knots.empty() && !shape.placement) knots = interpolating(knots, t);
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

/// The stated weight of every move; none: the best.
std::optional<double> weight_of(const Settings& settings) {
    const MethodEntry& entry = method_entry("pia");
    const std::optional<double> stated = setting(settings, "weight");
    if (setting(entry, settings, "best_weight") == 0) return stated.value_or(1);
    if (stated)
        throw InvalidInput(
            "settings weight and best_weight = 1 of method pia: one of them at most");
    return {};
}

} // namespace

Fitted fit_pia(const Problem& problem, std::string_view) {
    Stopwatch watch;
    const Samples& samples = problem.samples;
    const MethodOptions& method = problem.options.method;
    if (method.settings.contains("threshold") &&
        problem.options.hold.preserve != Preserve::convexity)
        throw InvalidInput("setting threshold of method pia: only where convexity is preserved");
    const Setting setting =
        is_setting_of_2004(problem) ? setting_of_2004(samples) : square_setting(problem);
    const DataSide data(setting.axes, samples, setting.parameters,
                        single_samples(setting, samples.shape()));
    PointSet start = method.initial == Initial::data
                         ? own_samples(data.groups(), samples)
                         : initial_control(samples, setting.parameters, setting.axes, method);
    Pia pia(data, weight_of(method.settings), method.moving);
    Course course = iterated(pia, {std::move(start)}, setting.axes, problem.options,
                             [&](const PointSet& at) { return largest_length(data.residual(at)); });
    course.report.seconds.emplace_back("solve", watch.lap());
    return {Spline::from_free(setting.axes, course.control), setting.parameters,
            std::move(course.report)};
}

} // namespace batten
