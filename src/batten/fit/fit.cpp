#include <batten/fit/fit.hpp>

#include <batten/core/counts.hpp>
#include <batten/core/large_array.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/drivers/choose.hpp>
#include <batten/drivers/curve_passes.hpp>
#include <batten/fit/account.hpp>
#include <batten/fit/rescale.hpp>
#include <batten/fit/reweight.hpp>
#include <batten/fit/written_shape.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/problem/subset.hpp>
#include <batten/robust/outliers.hpp>
#include <batten/samples/passes.hpp>
#include <batten/samples/scan.hpp>
#include <batten/system/roughness.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// Where a stated factor of roughness leaves something undetermined.
const char* what_may_do(const Problem& problem) {
    const bool none =
        problem.kind == SampleKind::cloud &&
        !determine_smoothest(problem.parameters.scattered, problem.options.smooth.order);
    return none ? "no factor does: their parameters do not even determine the smoothest surface"
                : "another factor may do";
}

/// The driver's answer. Where nobody named a driver and the direct solution finds control points
/// that no sample determines after all, an iteration leaves these where it starts.
Fitted answered(const Problem& problem, const Choice& choice) {
    const auto by = [&](const Driver& driver, const std::string& reason) {
        Fitted fitted = driver.fit(problem, driver.name);
        fitted.report.method = driver.name;
        fitted.report.method_reason = reason;
        return fitted;
    };
    try {
        return by(*choice.driver, choice.reason);
    } catch (const SolverError& error) {
        const Driver& other = driver("cg");
        const bool smooth = problem.options.smooth.wanted;
        const bool others = !choice.reason.empty() && choice.driver->name == "direct" &&
                            other.takes(problem.kind)->covers(requests_of(problem));
        if (others && smooth && problem.kind == SampleKind::cloud)
            if (Fitted fitted = by(other, error.what());
                fitted.report.termination == Termination::converged)
                return fitted; // else nothing is determined but for rounding
        if (problem.options.smooth.lambda > 0)
            throw InvalidInput(fmt::format("smoothing by {}: {}; {}", problem.options.smooth.lambda,
                                           error.what(), what_may_do(problem)));
        if (!others || smooth) throw;
        return by(other, fmt::format("{}: an iteration leaves it where it starts", error.what()));
    }
}

FitResult solved(const Problem& problem, double problem_seconds) {
    Stopwatch watch;
    const Choice choice = choose(problem);
    const double choice_seconds = watch.lap();
    Fitted fitted = answered(problem, choice);
    keep_as_written(fitted);
    problem.stop_if_cancelled();
    watch.lap();
    FitResult result = accounted(std::move(fitted), problem);
    auto& seconds = result.report.seconds;
    seconds.insert(seconds.begin(), {{"problem", problem_seconds}, {"choice", choice_seconds}});
    seconds.emplace_back("deviation", watch.lap());
    return result;
}

/// The result of the samples that were kept, in terms of all.
FitResult with_outliers(FitResult result, const Problem& problem,
                        const std::vector<Index>& outliers) {
    if (outliers.empty()) return result;
    FitReport& report = result.report;
    report.set_aside = outliers;
    const Subset kept = Subset::without(outliers, problem.samples.size());
    if (problem.kind != SampleKind::grid) {
        report.samples = problem.samples.size();
        if (problem.kind == SampleKind::cloud)
            result.parameters = problem.parameters;
        else
            result.parameters.axes[0] = kept.spread(result.parameters.axes[0]);
    }
    result.deviations =
        deviations(result.spline, problem.samples, result.parameters, report.deviation.kind);
    report.deviation = summarise(kept.of(result.deviations), report.deviation.kind);
    report.deviation.worst_sample = kept.original(report.deviation.worst_sample);
    return result;
}

/// Without what nobody wants.
FitResult kept(FitResult result, const FitOptions& options) {
    if (options.keep_per_sample) return result;
    result.parameters = {};
    result.deviations = {};
    return result;
}

FitResult fit_in_memory(const Samples& samples, const FitOptions& options);

/// In passes where that can be, else in memory; unusual weights first made usual.
FitResult fit_either_way(const Samples& samples, const FitOptions& options) {
    if (const double unit = usual_weight(samples.weights, options); unit != 1) {
        check(samples); // names what the caller stated
        return reweighted(fit_either_way(reweighted(samples, unit), reweighted(options, unit)),
                          unit);
    }
    MemorySource source(samples);
    if (auto passed = fit_in_passes(source, options))
        return accounted(std::move(*passed), samples.notes, options);
    return fit_in_memory(samples, options);
}

/// Of samples in memory with usual weights, whatever is asked; unusual units first made usual.
FitResult fit_in_memory(const Samples& samples, const FitOptions& options) {
    Stopwatch watch;
    const PointScan scan = scanned(samples.points);
    if (const double unit = usual_unit(scan.box()); unit != 1)
        return rescaled(fit_either_way(rescaled(samples, unit), rescaled(options, unit)), 1 / unit);
    Problem problem = problem_of(samples, options, scan);
    if (!samples.weights.empty() &&
        std::ranges::all_of(samples.weights, [](double w) { return w == 1; })) {
        choose(problem); // refuses what cannot weigh samples
        problem.samples.weights.clear();
    }
    if (options.outliers == Outliers::count) return solved(problem, watch.lap());
    choose(problem); // refuses what cannot be before the work is done
    const WithoutOutliers found = without_outliers(problem);
    return with_outliers(solved(found.rest, watch.lap()), problem, found.outliers);
}

/// A source's samples, read into memory.
struct Held {
    Samples samples;
    double seconds = 0;
};

Held held(SampleSource& source) {
    Stopwatch watch;
    const Index dim = source.dim();
    const auto check = [&](Index count) {
        check_memory(count * dim, "samples in memory, which what is asked needs");
    };
    if (source.size() > 0) check(source.size());
    LargeArray values;
    std::vector<double> weights;
    if (source.size() > 0) values.reserve(static_cast<std::size_t>(source.size() * dim));
    source.rewind();
    for (Points points = source.next(chunk_samples); !points.empty();
         points = source.next(chunk_samples)) {
        const std::size_t before = values.size();
        const std::size_t after = before + static_cast<std::size_t>(points.size() * dim);
        if (after > values.capacity()) {
            check(2 * static_cast<Index>(after) / dim);
            values.reserve(2 * after);
        }
        values.resize(after);
        std::copy_n(points.data(), after - before, values.data() + before);
        const auto own = source.weights();
        weights.insert(weights.end(), own.begin(), own.end());
    }
    const Index count = static_cast<Index>(values.size()) / dim;
    return {{.points = std::move(values).points(count, dim),
             .grid = source.grid(),
             .weights = std::move(weights),
             .order = source.order(),
             .spacing = source.spacing(),
             .notes = source.notes()},
            watch.lap()};
}

} // namespace

FitResult fit(SampleSource& source, const FitOptions& options) {
    const ThreadLimit limit(options.threads);
    check_settings(method_entry(options.method.name), options.method.settings);
    const Index before = source.bytes();
    if (auto passed = fit_in_passes(source, options))
        return accounted(std::move(*passed), source.notes(), options);
    const Held in_memory = held(source);
    FitResult result = fit_either_way(in_memory.samples, options);
    result.report.bytes_read = source.bytes() - before;
    auto& seconds = result.report.seconds;
    seconds.insert(seconds.begin(), {"reading", in_memory.seconds});
    return kept(std::move(result), options);
}

FitResult fit(const Samples& samples, const FitOptions& options) {
    const ThreadLimit limit(options.threads);
    check_settings(method_entry(options.method.name), options.method.settings);
    check_shape(samples);
    return kept(fit_either_way(samples, options), options);
}

} // namespace batten
