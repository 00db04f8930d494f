#include <batten/drivers/epia_driver.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/epia_incremental.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/problem/initial.hpp>
#include <batten/problem/plan.hpp>
#include <batten/problem/subset.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

EpiaSettings settings_from(const FitOptions& options, double data_size) {
    const Settings& s = options.method.settings;
    const MethodEntry& entry = method_entry("epia");
    const auto number = [&](const char* name) { return setting(entry, s, name); };
    const double close_moves =
        options.stop.deviation > 0 ? 0.9 * options.stop.deviation : 2.5e-3 * data_size;
    return {number("eta"), setting(s, "t_c").value_or(close_moves),
            static_cast<Index>(number("rounds")), static_cast<Index>(number("smoothing")),
            number("exact") == 1};
}

/// Samples of a sequence that repeat the one before: curvature needs distinct neighbours.
std::vector<Index> repetitions(const Samples& samples) {
    std::vector<Index> repeated;
    for (Index i = 1; samples.grid.empty() && i < samples.size(); ++i)
        if (std::ranges::equal(samples.points[i], samples.points[i - 1])) repeated.push_back(i);
    return repeated;
}

/// The problem in which a held sample that repeats the one before is that one.
Problem with_firsts_held(Problem problem, const std::vector<Index>& repeated) {
    std::vector<Index>& held = problem.options.hold.interpolate;
    for (Index& i : held)
        while (std::ranges::binary_search(repeated, i)) --i;
    std::ranges::sort(held);
    held.erase(std::unique(held.begin(), held.end()), held.end());
    return problem;
}

/// A sample that repeats the one before has its parameter, too.
Parameters with_repetitions(const Subset& distinct, const Parameters& own, Index count) {
    if (distinct.whole()) return own;
    std::vector<double> t;
    for (Index i = 0; i < count; ++i)
        t.push_back(own.axes[0][static_cast<std::size_t>(distinct.place(i + 1) - 1)]);
    return {{std::move(t)}, {}};
}

/// A cloud: fixed knots, every sample in the group of its nearest control point [LinZhang2011,
/// section 6].
Fitted fit_cloud(const Problem& problem) {
    if (!problem.options.method.settings.empty())
        throw InvalidInput(fmt::format("epia: setting {} is for sequences and grids, a cloud's "
                                       "groups and knots are fixed",
                                       problem.options.method.settings.begin()->first));
    const std::vector<KnotVector> axes = fixed_knots(problem);
    const DataSide data(axes, problem.samples, problem.parameters,
                        nearest_groups(problem.parameters, axes));
    Pia pia(data);
    Course course = iterated(
        pia, {initial_control(problem.samples, problem.parameters, axes, problem.options.method)},
        axes, problem.options,
        [&](const PointSet& at) { return largest_length(data.residual(at)); });
    return {Spline::from_free(axes, course.control), problem.parameters, std::move(course.report)};
}

} // namespace

Fitted fit_epia(const Problem& given, std::string_view) {
    if (given.kind == SampleKind::cloud) return fit_cloud(given);
    if (given.axes.count() > 2)
        throw InvalidInput("epia: sequences and grids of 2 axes are possible");
    if (!(given.options.stop.deviation > 0) && given.axes.control_points.empty())
        throw InvalidInput("epia: state where to stop: a stop deviation or a number of control "
                           "points");
    Stopwatch watch;
    const std::vector<Index> repeated = repetitions(given.samples);
    const Subset distinct = Subset::without(repeated, given.samples.size());
    const Problem problem = distinct.of(with_firsts_held(given, repeated));
    const EpiaSettings settings = settings_from(given.options, given.size);
    Fitted fitted = fit_incrementally(problem, settings);
    fitted.parameters = with_repetitions(distinct, problem.parameters, given.samples.size());
    fitted.report.settings = {{"eta", settings.eta},
                              {"t_c", settings.t_c},
                              {"rounds", static_cast<double>(settings.rounds)},
                              {"smoothing", static_cast<double>(settings.smoothing)},
                              {"exact", settings.exact ? 1.0 : 0.0}};
    fitted.report.seconds.emplace_back("solve", watch.lap());
    if (!repeated.empty())
        fitted.report.notes.push_back(fmt::format(
            "{} identical consecutive samples dropped before the curvature", repeated.size()));
    return fitted;
}

} // namespace batten
