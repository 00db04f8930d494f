#include <batten/drivers/epia_driver.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/epia_axis.hpp>
#include <batten/drivers/least_squares.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/problem/plan.hpp>
#include <batten/samples/curvature.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// The method's own numbers.
struct EpiaSettings {
    double eta;
    double t_c;
    Index rounds;
    Index smoothing;
    bool exact;
};

EpiaSettings settings_from(const FitOptions& options, double data_size) {
    const Settings& s = options.method.settings;
    const MethodEntry& entry = method_entry("epia");
    check_settings(entry, s);
    const auto number = [&](const char* name) { return setting(entry, s, name); };
    const double close_moves =
        options.stop.deviation > 0 ? 0.9 * options.stop.deviation : 2.5e-3 * data_size;
    return {number("eta"), setting(s, "t_c").value_or(close_moves),
            static_cast<Index>(number("rounds")), static_cast<Index>(number("smoothing")),
            number("exact") == 1};
}

/// A sequence without identical consecutive samples (curvature needs distinct neighbours); grids
/// stay as they are.
struct Distinct {
    Samples samples;
    std::vector<Index> place; ///< of every given sample among the distinct ones
};

Distinct without_repetitions(const Samples& samples) {
    Distinct result{samples, {}};
    if (!samples.grid.empty()) return result;
    std::vector<double> kept;
    for (Index i = 0; i < samples.size(); ++i) {
        const auto p = samples.points[i];
        if (i == 0 || !std::ranges::equal(p, samples.points[i - 1]))
            kept.insert(kept.end(), p.begin(), p.end());
        result.place.push_back(static_cast<Index>(kept.size()) / samples.dim() - 1);
    }
    result.samples.points = Points(PointSet(std::move(kept), samples.dim()));
    return result;
}

/// Curvature along an axis: of the sequence, or total curvatures averaged over the other axis of a
/// grid [eq. 32 and 33].
std::vector<double> axis_curvature(const Samples& samples, std::size_t axis, Index smoothing) {
    if (samples.grid.empty()) return discrete_curvature(samples.points, smoothing);
    const Index m0 = samples.grid[0];
    const Index m1 = samples.grid[1];
    std::vector<double> total(static_cast<std::size_t>(m0 * m1));
    const auto add_lines = [&](Index lines, Index count, Index line_step, Index step) {
        for (Index line = 0; line < lines; ++line) {
            PointSet strand(count, samples.dim());
            for (Index j = 0; j < count; ++j)
                std::ranges::copy(samples.points[line * line_step + j * step], strand[j].begin());
            const std::vector<double> k = discrete_curvature(strand, smoothing);
            for (Index j = 0; j < count; ++j)
                total[static_cast<std::size_t>(line * line_step + j * step)] +=
                    k[static_cast<std::size_t>(j)] * k[static_cast<std::size_t>(j)];
        }
    };
    add_lines(m0, m1, m1, 1);
    add_lines(m1, m0, 1, m1);
    std::vector<double> mean(static_cast<std::size_t>(axis == 0 ? m0 : m1));
    for (Index i = 0; i < m0; ++i)
        for (Index j = 0; j < m1; ++j)
            mean[static_cast<std::size_t>(axis == 0 ? i : j)] +=
                total[static_cast<std::size_t>(i * m1 + j)] /
                static_cast<double>(axis == 0 ? m1 : m0);
    return mean;
}

/// The incremental fit's state between insertions.
class Incremental {
  public:
    Incremental(const Samples& samples, const Parameters& parameters, const FitOptions& options,
                const EpiaSettings& settings, const std::vector<Index>& alone)
        : samples_(samples), parameters_(parameters), options_(options), settings_(settings) {
        const std::vector<int> degree =
            degrees_per_axis(options.shape, static_cast<Index>(parameters.axes.size()));
        for (std::size_t k = 0; k < parameters.axes.size(); ++k) {
            std::vector<double> curvature = axis_curvature(samples, k, settings.smoothing);
            std::vector<Index> dominant = dominant_indices(curvature);
            axes_.emplace_back(degree[k], parameters.axes[k], std::move(curvature),
                               std::move(dominant), alone);
        }
    }

    FitResult fit(FitReport report) {
        for (Index round = 0; round < settings_.rounds && split_invalid(); ++round) {
        }
        PointSet control = initial_points();
        Spline spline = Spline::from_free(knots(), control);
        report.notes.push_back(fmt::format("epia started with {} control points", control.size()));
        Index left = options_.stop.max_iterations;
        while (true) {
            const DataSide data(spline.axes(), samples_, parameters_, groups());
            control = spline.free_control_points();
            const bool insert = one_run(data, control, left, report);
            spline = Spline::from_free(spline.axes(), control);
            if (!insert) break;
            const Spline refined = with_knot_inserted(spline, data.residual(control));
            if (refined.control_points().size() ==
                control.size()) { // every sample is a control point's own
                report.termination = Termination::stalled;
                break;
            }
            spline = refined;
        }
        report.iterations = options_.stop.max_iterations - left;
        return {std::move(spline), std::move(report), {}};
    }

  private:
    std::vector<KnotVector> knots() const {
        std::vector<KnotVector> result;
        for (const EpiaAxis& axis : axes_) result.push_back(axis.knots());
        return result;
    }

    SampleGroups groups() const {
        std::vector<std::vector<SampleRange>> ranges;
        for (const EpiaAxis& axis : axes_) ranges.push_back(axis.groups());
        return {std::move(ranges), samples_.shape()};
    }

    /// P^0: the dominant samples themselves [eq. 31 and 36].
    PointSet initial_points() const {
        std::vector<double> values;
        const auto append = [&](Index sample) {
            const auto p = samples_.points[sample];
            values.insert(values.end(), p.begin(), p.end());
        };
        for (Index i : axes_[0].controls()) {
            if (axes_.size() == 1)
                append(i);
            else
                for (Index j : axes_[1].controls()) append(i * samples_.grid[1] + j);
        }
        return {std::move(values), samples_.dim()};
    }

    /// Splits the groups whose residuals do not point one way [eq. 47], by their own fence markers;
    /// false when all are valid.
    bool split_invalid() {
        const DataSide data(knots(), samples_, parameters_, groups());
        Pia step(data);
        step.propose(initial_points());
        const std::vector<bool> valid = step.valid(settings_.eta);
        std::vector<std::vector<Index>> markers(axes_.size());
        for (std::size_t c = 0; c < valid.size(); ++c) {
            if (valid[c]) continue;
            std::size_t rest = c;
            for (std::size_t k = axes_.size(); k-- > 0;) {
                const std::size_t n = axes_[k].controls().size();
                const SampleRange range = axes_[k].groups()[rest % n];
                if (range.begin > 0) markers[k].push_back(range.begin);
                if (rest % n + 1 < n) markers[k].push_back(range.end);
                rest /= n;
            }
        }
        bool any = false;
        for (std::size_t k = 0; k < axes_.size(); ++k)
            for (Index marker : markers[k])
                if (!axes_[k].has(marker)) {
                    axes_[k].insert(marker);
                    any = true;
                }
        return any;
    }

    Index count() const {
        Index n = 1;
        for (const EpiaAxis& axis : axes_) n *= static_cast<Index>(axis.controls().size());
        return n;
    }

    /// Whether the stated number of control points, if any, forbids more.
    bool full() const {
        const auto& limit = options_.shape.control_points;
        for (std::size_t k = 0; k < axes_.size() && !limit.empty(); ++k)
            if (static_cast<Index>(axes_[k].controls().size()) >= limit[limit.size() == 1 ? 0 : k])
                return true;
        return false;
    }

    /// Iterates until an insertion is due (true) or the fit ends (false); `left` counts down the
    /// iterations allowed.
    bool one_run(const DataSide& data, PointSet& control, Index& left, FitReport& report) {
        Pia pia(data, 1, {}, Divergence::allowed); // a growing error inserts a knot
        FitOptions options = options_;
        options.most_frames = 0; // their polygons would be of several sizes
        options.stop.max_iterations = left;
        options.stop.relative_gradient = full() ? options_.stop.relative_gradient : 0;
        bool due = false;
        bool insert = false;
        options.observer = [&](const Iteration& now) {
            if (options_.observer && options_.observer(now) == Continue::no) return Continue::no;
            if (due) { // the moves after which the insertion is due have been made
                insert = true;
                return Continue::no;
            }
            const double e_d = largest_length(pia.residual());
            const double e_c = largest_length(pia.data_means());
            due = !full() && (e_c < settings_.t_c || e_d > last_error_);
            last_error_ = e_d;
            return Continue::yes;
        };
        const std::size_t before = report.history.size();
        const Index done = options_.stop.max_iterations - left;
        run(
            pia, control, options, data.axes(),
            [&](const PointSet&) { return largest_length(pia.residual()); }, report);
        left -= report.iterations;
        for (std::size_t k = before; k < report.history.size(); ++k)
            report.history[k].iteration += done;
        if (before > 0 && before < report.history.size())
            report.history.erase(report.history.begin() + static_cast<Index>(before) -
                                 1); // one entry per iteration
        if (report.termination == Termination::converged && options_.stop.deviation > 0)
            report.termination = Termination::tolerance_met;
        if (insert) last_error_ = std::numeric_limits<double>::infinity();
        if (insert && left == 0) report.termination = Termination::iteration_limit;
        return insert && left > 0;
    }

    /// The spline with the worst sample's parameters inserted that are not control points' own yet;
    /// unchanged when there is none.
    Spline with_knot_inserted(const Spline& spline, const PointSet& residual) {
        std::vector<std::pair<double, Index>> worst;
        for (Index j = 0; j < residual.size(); ++j) {
            double square = 0;
            for (double x : residual[j]) square += x * x;
            worst.emplace_back(-square, j);
        }
        std::sort(worst.begin(), worst.end());
        for (const auto& [square, sample] : worst) {
            Index rest = sample;
            Spline refined = spline;
            for (std::size_t k = axes_.size(); k-- > 0;) {
                const Index m = samples_.shape()[k];
                const Index at = rest % m;
                rest /= m;
                if (axes_[k].has(at)) continue;
                refined = insert_knot(refined, static_cast<Index>(k), axes_[k].parameter(at));
                axes_[k].insert(at);
            }
            if (refined.control_points().size() == spline.control_points().size()) continue;
            if (settings_.exact) return refined;
            return {
                knots(),
                refined.control_points()}; // the curve moves a little with the regenerated knots
        }
        return spline;
    }

    const Samples& samples_;
    const Parameters& parameters_;
    const FitOptions& options_;
    EpiaSettings settings_;
    std::vector<EpiaAxis> axes_;
    double last_error_ = std::numeric_limits<double>::infinity();
};

/// A cloud with given parameters: fixed knots, every sample in the group of its nearest control
/// point [LinZhang2011, section 6].
FitResult fit_cloud(const Samples& samples, const FitOptions& options) {
    FitResult result;
    const AxisPlan plan = plan_axes(samples, options.shape);
    result.parameters = choose_parameters(samples, options.shape, plan);
    const std::vector<KnotVector> axes = choose_knots(result.parameters, options.shape, plan);
    SampleGroups groups = nearest_groups(result.parameters, axes);
    const DataSide data(axes, samples, result.parameters, std::move(groups));
    PointSet control = initial_control(samples, result.parameters, axes, options.method);
    result.report.method = "epia";
    Pia pia(data);
    run(
        pia, control, options, axes,
        [&](const PointSet& at) { return largest_length(data.residual(at)); }, result.report);
    result.spline = Spline::from_free(axes, control);
    return result;
}

} // namespace

FitResult fit_epia(const Samples& samples, const FitOptions& options) {
    for (Closure closure : options.shape.closures)
        if (closure == Closure::closed)
            throw InvalidInput(
                "epia: closed axes are not part of the method; fit open, or use another method");
    if (options.shape.parameters && options.shape.parameters->is_scattered())
        return fit_cloud(samples, options);
    if (samples.axis_count() > 2)
        throw InvalidInput("epia: sequences and grids of 2 axes are possible");
    if (!(options.stop.deviation > 0) && options.shape.control_points.empty())
        throw InvalidInput("epia: state where to stop: a deviation (--stop-deviation) or a number "
                           "of control points");
    Stopwatch watch;
    const EpiaSettings settings = settings_from(options, diagonal(samples.points));
    const Distinct distinct = without_repetitions(samples);
    std::vector<Index> alone;
    for (Index i : options.hold.interpolate) {
        if (i < 0 || i >= samples.size())
            throw InvalidInput(fmt::format("interpolated sample {}: the samples are 0 to {}", i,
                                           samples.size() - 1));
        if (!samples.grid.empty())
            throw InvalidInput("epia: single samples are interpolated in sequences only");
        alone.push_back(distinct.place[static_cast<std::size_t>(i)]);
    }
    const std::vector<Closure> open(static_cast<std::size_t>(samples.axis_count()), Closure::open);
    const Parameters parameters =
        parametrize(distinct.samples, options.shape.parametrization, open);
    FitReport report;
    report.method = "epia";
    report.seconds.emplace_back("parametrize", watch.lap());
    FitResult result =
        Incremental(distinct.samples, parameters, options, settings, alone).fit(std::move(report));
    result.parameters = parametrize(samples, options.shape.parametrization, open);
    result.report.seconds.emplace_back("solve", watch.lap());
    if (distinct.samples.size() < samples.size())
        result.report.notes.push_back(
            fmt::format("{} identical consecutive samples dropped before the curvature",
                        samples.size() - distinct.samples.size()));
    return result;
}

} // namespace batten
