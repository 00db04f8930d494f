#include <batten/drivers/epia_incremental.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/drivers/epia_course.hpp>
#include <batten/problem/initial.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// Algorithm 1: the axes, what goes on between insertions, and the insertions.
class Incremental {
  public:
    Incremental(const Problem& problem, const EpiaSettings& settings)
        : problem_(problem),
          exact_(settings.exact),
          start_(epia_start(problem, settings)),
          axes_(start_.axes),
          course_(problem, settings.t_c) {}

    Fitted fit() {
        Spline spline = Spline::from_free(knots_of(axes_), start());
        const Index first = spline.control_points().size();
        Index insertions = 0;
        while (true) {
            const DataSide data(
                spline.axes(), problem_.samples, problem_.parameters,
                {groups_of(axes_), problem_.samples.shape(), problem_.samples.weights});
            EpiaCourse::Run run = course_.run(data, spline.free_control_points(), full());
            spline = Spline::from_free(spline.axes(), run.control);
            if (!run.insert) {
                FitReport report = course_.report(data, std::move(run.control));
                report.settings["rounds_made"] = static_cast<double>(start_.rounds);
                report.settings["insertions"] = static_cast<double>(insertions);
                report.notes.push_back(fmt::format(
                    "epia started with {} control points{}", first,
                    limited() && insertions == 0 ? ", as many as stated or more: none is added"
                                                 : ""));
                report.notes.insert(report.notes.end(), start_.notes.begin(), start_.notes.end());
                return {std::move(spline), problem_.parameters, std::move(report)};
            }
            spline = with_knot_inserted(spline, run.residual);
            ++insertions;
        }
    }

  private:
    /// P^0: stated control points, or the axes' own samples [eq. 31 and 36].
    PointSet start() const {
        const MethodOptions& method = problem_.options.method;
        return method.initial == Initial::data
                   ? own_samples(axes_, problem_.samples)
                   : initial_control(problem_.samples, problem_.parameters, knots_of(axes_),
                                     method);
    }

    /// Whether the stated number of control points, if any, forbids more.
    bool limited() const {
        const std::vector<Index>& limit = problem_.axes.control_points;
        for (std::size_t k = 0; k < limit.size(); ++k)
            if (axes_[k].control_count() >= limit[k]) return true;
        return false;
    }

    /// Whether no knot can come: by that number, where only some control points move, or with every
    /// sample a control point's own, from where on this is the classical PIA.
    bool full() const {
        return limited() || !problem_.options.method.moving.empty() ||
               std::ranges::all_of(axes_, [](const EpiaAxis& axis) {
                   return axis.control_count() == axis.sample_count();
               });
    }

    /// The farthest sample of those that are not control points' own along every axis. Where
    /// samples have their own precision the rest may be good enough already: then a neighbour of
    /// the farthest that is a control point's own.
    GridIndex::Place worst(const PointSet& residual) const {
        GridIndex::Place fresh{};
        GridIndex::Place farthest{};
        double most = -1;
        double most_of_all = -1;
        GridIndex(problem_.samples.shape()).for_each([&](const GridIndex::Place& at, Index j) {
            const double far = course_.far(residual, j);
            if (far > most_of_all) farthest = at;
            most_of_all = std::max(most_of_all, far);
            if (!(far > most)) return;
            bool own = true;
            for (std::size_t k = 0; k < axes_.size(); ++k) own = own && axes_[k].has(at[k]);
            if (own) return;
            fresh = at;
            most = far;
        });
        if (problem_.tolerance.empty() || most == most_of_all) return fresh;
        for (std::size_t k = 0; k < axes_.size(); ++k)
            farthest[k] = axes_[k].nearest_free(farthest[k]);
        return farthest;
    }

    /// The spline with the worst sample's parameters inserted that are not control points' own yet.
    Spline with_knot_inserted(const Spline& spline, const PointSet& residual) {
        const GridIndex::Place place = worst(residual);
        Spline refined = spline;
        for (std::size_t k = axes_.size(); k-- > 0;)
            if (axes_[k].insert({place[k]}))
                refined = insert_knot(refined, static_cast<Index>(k), axes_[k].parameter(place[k]));
        if (exact_) return refined;
        return {knots_of(axes_), refined.control_points()}; // moves a little with these knots
    }

    const Problem& problem_;
    bool exact_;
    EpiaStart start_;
    std::vector<EpiaAxis> axes_;
    EpiaCourse course_;
};

} // namespace

Fitted fit_incrementally(const Problem& problem, const EpiaSettings& settings) {
    return Incremental(problem, settings).fit();
}

} // namespace batten
