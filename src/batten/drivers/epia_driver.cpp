#include <batten/drivers/epia_driver.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/core/stopwatch.hpp>
#include <batten/drivers/epia_axis.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/problem/initial.hpp>
#include <batten/problem/plan.hpp>
#include <batten/problem/subset.hpp>
#include <batten/samples/curvature.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

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

/// Curvature along an axis: of the sequence, or total curvatures averaged over the other axis of a
/// grid [eq. 32 and 33].
std::vector<double> axis_curvature(const Samples& samples, std::size_t axis, Index smoothing) {
    if (samples.grid.empty()) return discrete_curvature(samples.points, smoothing);
    const GridIndex grid(samples.grid);
    std::vector<double> total(static_cast<std::size_t>(grid.size()));
    for (std::size_t along : {std::size_t{1}, std::size_t{0}})
        grid.for_each_strand(along, [&](const GridIndex::Strand& strand) {
            PointSet line(strand.count, samples.dim());
            for (Index j = 0; j < strand.count; ++j)
                std::ranges::copy(samples.points[strand[j]], line[j].begin());
            const std::vector<double> k = discrete_curvature(line, smoothing);
            for (Index j = 0; j < strand.count; ++j) {
                const double bend = k[static_cast<std::size_t>(j)];
                total[static_cast<std::size_t>(strand[j])] += bend * bend;
            }
        });
    std::vector<double> mean(static_cast<std::size_t>(grid.length(axis)));
    const auto others = static_cast<double>(grid.length(1 - axis));
    grid.for_each([&](const GridIndex::Place& place, Index at) {
        mean[static_cast<std::size_t>(place[axis])] += total[static_cast<std::size_t>(at)] / others;
    });
    return mean;
}

/// The incremental fit's state between insertions.
class Incremental {
  public:
    Incremental(const Problem& problem, const EpiaSettings& settings)
        : problem_(problem), settings_(settings), left_(problem.options.stop.max_iterations) {
        const auto& t = problem.parameters.axes;
        for (std::size_t k = 0; k < t.size(); ++k) {
            std::vector<double> curvature = axis_curvature(problem.samples, k, settings.smoothing);
            std::vector<Index> dominant = dominant_indices(curvature);
            axes_.emplace_back(problem.axes.degree[k], t[k], std::move(curvature),
                               std::move(dominant), problem.options.hold.interpolate);
        }
    }

    Fitted fit() {
        for (Index round = 0; round < settings_.rounds && split_invalid(); ++round) {
        }
        PointSet control = initial_points();
        Spline spline = Spline::from_free(knots(), control);
        report_.notes.push_back(
            fmt::format("epia started with {} control points{}", control.size(),
                        full() ? ", as many as stated or more: none is added" : ""));
        while (true) {
            const DataSide data(spline.axes(), problem_.samples, problem_.parameters, groups());
            const Run run = one_run(data, spline.free_control_points());
            spline = Spline::from_free(spline.axes(), run.control);
            if (!run.insert) break;
            const Spline refined = with_knot_inserted(spline, data.residual(run.control));
            if (refined.control_points().size() == run.control.size()) {
                report_.termination = Termination::stalled; // all samples are control points' own
                break;
            }
            spline = refined;
        }
        report_.iterations = problem_.options.stop.max_iterations - left_;
        return {std::move(spline), problem_.parameters, std::move(report_)};
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
        return {std::move(ranges), problem_.samples.shape()};
    }

    /// P^0: the dominant samples themselves [eq. 31 and 36].
    PointSet initial_points() const {
        std::vector<double> values;
        const auto append = [&](Index sample) {
            const auto p = problem_.samples.points[sample];
            values.insert(values.end(), p.begin(), p.end());
        };
        for (Index i : axes_[0].controls()) {
            if (axes_.size() == 1)
                append(i);
            else
                for (Index j : axes_[1].controls()) append(i * problem_.samples.grid[1] + j);
        }
        return {std::move(values), problem_.samples.dim()};
    }

    /// Splits the groups whose residuals do not point one way [eq. 47], by their own fence markers;
    /// false when all are valid.
    bool split_invalid() {
        const DataSide data(knots(), problem_.samples, problem_.parameters, groups());
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
        const std::vector<Index>& limit = problem_.axes.control_points;
        for (std::size_t k = 0; k < limit.size(); ++k)
            if (static_cast<Index>(axes_[k].controls().size()) >= limit[k]) return true;
        return false;
    }

    /// The control points after a run, and whether an insertion is due.
    struct Run {
        PointSet control;
        bool insert;
    };

    /// Iterates until an insertion is due or the fit ends.
    Run one_run(const DataSide& data, PointSet start) {
        const FitOptions& given = problem_.options;
        Pia pia(data, 1, {}, Divergence::allowed); // a growing error inserts a knot
        FitOptions options = given;
        options.most_frames = 0; // their polygons would be of several sizes
        options.stop.max_iterations = left_;
        options.stop.relative_gradient = full() ? given.stop.relative_gradient : 0;
        bool due = false;
        bool insert = false;
        options.observer = [&](const Iteration& now) {
            if (given.observer && given.observer(now) == Continue::no) return Continue::no;
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
        Course course = iterated(pia, {std::move(start)}, data.axes(), options,
                                 [&](const PointSet&) { return largest_length(pia.residual()); });
        enter(std::move(course.report));
        if (insert) last_error_ = std::numeric_limits<double>::infinity();
        if (insert && left_ == 0) report_.termination = Termination::iteration_limit;
        return {std::move(course.control), insert && left_ > 0};
    }

    /// Joins a run's account to those before: one entry of the history per iteration.
    void enter(FitReport run) {
        const Index done = problem_.options.stop.max_iterations - left_;
        left_ -= run.iterations;
        for (HistoryEntry& entry : run.history) entry.iteration += done;
        if (!report_.history.empty() && !run.history.empty()) report_.history.pop_back();
        report_.history.insert(report_.history.end(), run.history.begin(), run.history.end());
        run.history = std::move(report_.history);
        run.notes = std::move(report_.notes);
        report_ = std::move(run);
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
                const Index m = problem_.samples.shape()[k];
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

    const Problem& problem_;
    EpiaSettings settings_;
    std::vector<EpiaAxis> axes_;
    FitReport report_;
    Index left_; ///< iterations that are allowed still
    double last_error_ = std::numeric_limits<double>::infinity();
};

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
        throw InvalidInput("epia: state where to stop: a deviation (--stop-deviation) or a number "
                           "of control points");
    Stopwatch watch;
    const std::vector<Index> repeated = repetitions(given.samples);
    const Subset distinct = Subset::without(repeated, given.samples.size());
    const Problem problem = distinct.of(with_firsts_held(given, repeated));
    const EpiaSettings settings = settings_from(given.options, given.size);
    Fitted fitted = Incremental(problem, settings).fit();
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
