#include <batten/drivers/epia_incremental.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/drivers/epia_axis.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/samples/curvature.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

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

    std::vector<std::vector<SampleRange>> ranges() const {
        std::vector<std::vector<SampleRange>> result;
        for (const EpiaAxis& axis : axes_) result.push_back(axis.groups());
        return result;
    }

    SampleGroups groups() const { return {ranges(), problem_.samples.shape()}; }

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
        const std::vector<std::vector<SampleRange>> fences = ranges();
        std::vector<Index> shape;
        for (const auto& along : fences) shape.push_back(static_cast<Index>(along.size()));
        GridIndex(shape).for_each([&](const GridIndex::Place& place, Index c) {
            if (valid[static_cast<std::size_t>(c)]) return;
            for (std::size_t k = 0; k < fences.size(); ++k) {
                const auto at = static_cast<std::size_t>(place[k]);
                const SampleRange range = fences[k][at];
                if (range.begin > 0) markers[k].push_back(range.begin);
                if (at + 1 < fences[k].size()) markers[k].push_back(range.end);
            }
        });
        bool any = false;
        for (std::size_t k = 0; k < axes_.size(); ++k)
            for (Index marker : markers[k])
                if (!axes_[k].has(marker)) {
                    axes_[k].insert(marker);
                    any = true;
                }
        return any;
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
        const GridIndex samples(problem_.samples.shape());
        for (const auto& [square, sample] : worst) {
            const GridIndex::Place place = samples.place(sample);
            Spline refined = spline;
            for (std::size_t k = axes_.size(); k-- > 0;) {
                const Index at = place[k];
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

} // namespace

Fitted fit_incrementally(const Problem& problem, const EpiaSettings& settings) {
    return Incremental(problem, settings).fit();
}

} // namespace batten
