#include <batten/drivers/epia_driver.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/epia_cloud.hpp>
#include <batten/drivers/epia_incremental.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/problem/subset.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

EpiaSettings settings_from(const Problem& problem) {
    const Settings& s = problem.options.method.settings;
    const MethodEntry& entry = method_entry("epia");
    const auto number = [&](const char* name) { return setting(entry, s, name); };
    double precision = problem.options.stop.deviation;
    if (!problem.tolerance.empty()) precision = std::ranges::min(problem.tolerance);
    const double close_moves = precision > 0 ? 0.9 * precision : 2.5e-3 * problem.size;
    return {number("eta"),
            setting(s, "t_c").value_or(close_moves),
            static_cast<Index>(number("rounds")),
            static_cast<Index>(number("smoothing")),
            number("exact") == 1,
            number("screen") == 1};
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

/// What a cloud's knots, placed by its samples, know nothing of.
void check_cloud(const Settings& settings) {
    for (const auto& [name, value] : settings)
        if (name != "t_c")
            throw InvalidInput(fmt::format("epia: setting {} is for sequences and grids, a cloud "
                                           "has no curvature to start from",
                                           name));
}

Fitted of_cloud(const Problem& problem, const EpiaSettings& settings) {
    check_cloud(problem.options.method.settings);
    return fit_cloud_incrementally(problem, settings);
}

/// A sequence or a grid.
Fitted of_lines(const Problem& given, const EpiaSettings& settings) {
    const std::vector<Index> repeated = repetitions(given.samples);
    const Subset distinct = Subset::without(repeated, given.samples.size());
    const Problem problem = distinct.of(with_firsts_held(given, repeated));
    Fitted fitted = fit_incrementally(problem, settings);
    fitted.parameters = with_repetitions(distinct, problem.parameters, given.samples.size());
    fitted.report.settings.merge(Settings{{"eta", settings.eta},
                                          {"rounds", static_cast<double>(settings.rounds)},
                                          {"smoothing", static_cast<double>(settings.smoothing)},
                                          {"exact", settings.exact ? 1.0 : 0.0},
                                          {"screen", settings.screen ? 1.0 : 0.0}});
    if (!repeated.empty())
        fitted.report.notes.push_back(fmt::format(
            "{} identical consecutive samples dropped before the curvature", repeated.size()));
    return fitted;
}

/// Whether every sample is within its own precision, in words.
void judge(FitReport& report, const Problem& problem) {
    report.tolerance = std::ranges::min(problem.tolerance);
    if (report.termination == Termination::tolerance_met) {
        report.verdict = "met at the samples' own parameters";
        return;
    }
    report.verdict = fmt::format("not met: {} after {} iterations", to_string(report.termination),
                                 report.iterations);
    report.termination = Termination::tolerance_not_met;
}

} // namespace

Fitted fit_epia(const Problem& given, std::string_view) {
    const bool cloud = given.kind == SampleKind::cloud;
    if (!cloud && given.axes.count() > 2)
        throw InvalidInput("epia: sequences and grids of 2 axes are possible");
    const bool start = given.options.method.initial == Initial::given;
    if (!(given.options.stop.deviation > 0) && given.tolerance.empty() && !given.sized() && !start)
        throw InvalidInput("epia: state where to stop: a stop deviation, a tolerance or a number "
                           "of control points");
    const EpiaSettings settings = settings_from(given);
    Stopwatch watch;
    Fitted fitted = cloud ? of_cloud(given, settings) : of_lines(given, settings);
    FitReport& report = fitted.report;
    report.settings.erase("weight");
    report.settings["t_c"] = settings.t_c;
    if (!given.tolerance.empty()) judge(report, given);
    report.seconds.emplace_back("solve", watch.lap());
    return fitted;
}

} // namespace batten
