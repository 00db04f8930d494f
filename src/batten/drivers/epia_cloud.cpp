#include <batten/drivers/epia_cloud.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/drivers/epia_course.hpp>
#include <batten/problem/initial.hpp>
#include <batten/problem/plan.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <optional>

namespace batten {

namespace {

/// The knots that a fit starts with: as stated, or those of one polynomial piece per axis.
std::vector<KnotVector> first_knots(Problem problem) {
    if (problem.sized()) return fixed_knots(problem);
    for (int degree : problem.axes.degree) problem.axes.control_points.push_back(degree + 1);
    return fixed_knots(problem);
}

/// A knot to come.
struct Insertion {
    std::size_t axis;
    double knot;
};

/// Where knots can come: half-way between two, if there are samples enough for the control points
/// across on both sides.
class Spans {
  public:
    explicit Spans(const Parameters& parameters) : parameters_(parameters) {
        const PointSet& at = parameters.scattered;
        for (Index k = 0; k < at.dim(); ++k) {
            sorted_.emplace_back();
            for (Index j = 0; j < at.size(); ++j) sorted_.back().push_back(at(j, k));
            std::ranges::sort(sorted_.back());
        }
    }

    /// The widest span, as a part of its axis, that holds the sample's parameter and can be halved.
    std::optional<Insertion> around(Index sample, const std::vector<KnotVector>& axes) const {
        std::optional<Insertion> result;
        double widest = 0;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            const double t = parameters_.scattered(sample, static_cast<Index>(k));
            const std::vector<double> breaks = axes[k].breakpoints();
            const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, t);
            const double middle = std::midpoint(*(after - 1), *after);
            const double part = (*after - *(after - 1)) / axes[k].length();
            if (part <= widest || !enough(k, *(after - 1), middle, axes) ||
                !enough(k, middle, *after, axes))
                continue;
            widest = part;
            result = {k, middle};
        }
        return result;
    }

  private:
    bool enough(std::size_t axis, double begin, double end,
                const std::vector<KnotVector>& axes) const {
        Index across = 1;
        for (std::size_t k = 0; k < axes.size(); ++k)
            if (k != axis) across *= axes[k].free_count();
        const std::vector<double>& t = sorted_[axis];
        return std::ranges::upper_bound(t, end) - std::ranges::lower_bound(t, begin) >= across;
    }

    const Parameters& parameters_;
    std::vector<std::vector<double>> sorted_; ///< parameters per axis
};

/// The knot that halves a span of the farthest sample where one can be halved; none anywhere.
std::optional<Insertion> next_knot(const EpiaCourse& course, const PointSet& residual,
                                   const Spans& spans, const std::vector<KnotVector>& axes) {
    std::vector<std::pair<double, Index>> worst;
    for (Index j = 0; j < residual.size(); ++j) worst.emplace_back(-course.far(residual, j), j);
    std::ranges::make_heap(worst, std::greater{});
    for (auto end = worst.end(); end != worst.begin(); --end) {
        std::pop_heap(worst.begin(), end, std::greater{});
        if (const auto found = spans.around((end - 1)->second, axes)) return found;
    }
    return std::nullopt;
}

std::string unmoved(const std::vector<GroupMember>& members, Index controls) {
    std::vector<bool> moves(static_cast<std::size_t>(controls));
    for (const GroupMember& member : members)
        moves[static_cast<std::size_t>(member.control)] = true;
    const auto still = std::ranges::count(moves, false);
    if (still == 0) return {};
    return fmt::format("{} of {} control points have no samples in their groups and stay where "
                       "they start",
                       still, controls);
}

} // namespace

Fitted fit_cloud_incrementally(const Problem& problem, const EpiaSettings& settings) {
    const std::vector<KnotVector> axes = first_knots(problem);
    const Parameters& parameters = problem.parameters;
    Spline spline = Spline::from_free(
        axes, initial_control(problem.samples, parameters, axes, problem.options.method));
    EpiaCourse course(problem, settings.t_c);
    const Spans spans(parameters);
    bool fixed = problem.sized() || !problem.options.method.moving.empty();
    for (Index insertions = 0;;) {
        const Index controls = GridIndex(free_shape(spline.axes())).size();
        const std::vector<GroupMember> members =
            nearest_groups(parameters, spline.axes(), problem.options.hold.interpolate);
        const DataSide data(spline.axes(), problem.samples, parameters,
                            {members, controls, problem.samples.weights});
        EpiaCourse::Run run = course.run(data, spline.free_control_points(), fixed);
        spline = Spline::from_free(spline.axes(), run.control);
        if (!run.insert) {
            FitReport report = course.report(data, std::move(run.control));
            report.settings["insertions"] = static_cast<double>(insertions);
            if (const std::string note = unmoved(members, controls); !note.empty())
                report.notes.push_back(note);
            return {std::move(spline), parameters, std::move(report)};
        }
        if (const auto next = next_knot(course, run.residual, spans, spline.axes())) {
            spline = insert_knot(spline, static_cast<Index>(next->axis), next->knot);
            ++insertions;
        } else {
            fixed = true; // no span has samples enough: on to the limit
        }
    }
}

} // namespace batten
