#include <batten/drivers/epia_cloud.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/drivers/epia_course.hpp>
#include <batten/problem/initial.hpp>
#include <batten/problem/plan.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

/// The knots that a fit starts with: as stated, or those of one polynomial piece per axis.
std::vector<KnotVector> first_knots(Problem problem) {
    if (problem.sized()) return fixed_knots(problem);
    for (int degree : problem.axes.degree) problem.axes.control_points.push_back(degree + 1);
    return fixed_knots(problem);
}

bool has_knot(const KnotVector& axis, double t) {
    return std::ranges::binary_search(axis.knots(), t);
}

/// The farthest sample whose parameters are not all knots; -1 where there is none.
Index worst(const EpiaCourse& course, const PointSet& residual, const Parameters& parameters,
            const std::vector<KnotVector>& axes) {
    Index result = -1;
    double most = -1;
    for (Index j = 0; j < residual.size(); ++j) {
        const double far = course.far(residual, j);
        bool fresh = false;
        for (std::size_t k = 0; k < axes.size() && far > most; ++k)
            fresh = fresh || !has_knot(axes[k], parameters.scattered(j, static_cast<Index>(k)));
        if (!fresh) continue;
        most = far;
        result = j;
    }
    return result;
}

std::string unmoved(const std::vector<Index>& owner, Index controls) {
    std::vector<Index> own = owner;
    std::ranges::sort(own);
    own.erase(std::unique(own.begin(), own.end()), own.end());
    const auto with = std::ranges::count_if(own, [](Index control) { return control >= 0; });
    if (with == controls) return {};
    return fmt::format("{} of {} control points have no samples in their groups and stay where "
                       "they start",
                       controls - with, controls);
}

} // namespace

Fitted fit_cloud_incrementally(const Problem& problem, const EpiaSettings& settings) {
    const std::vector<KnotVector> axes = first_knots(problem);
    const Parameters& parameters = problem.parameters;
    Spline spline = Spline::from_free(
        axes, initial_control(problem.samples, parameters, axes, problem.options.method));
    EpiaCourse course(problem, settings.t_c);
    const bool fixed = problem.sized() || !problem.options.method.moving.empty();
    for (Index insertions = 0;; ++insertions) {
        const Index controls = GridIndex(free_shape(spline.axes())).size();
        const std::vector<Index> owner =
            nearest_controls(parameters, spline.axes(), problem.options.hold.interpolate);
        const DataSide data(spline.axes(), problem.samples, parameters,
                            SampleGroups(owner, controls, problem.samples.weights));
        EpiaCourse::Run run = course.run(data, spline.free_control_points(),
                                         fixed || controls >= problem.samples.size());
        spline = Spline::from_free(spline.axes(), run.control);
        const Index sample =
            run.insert ? worst(course, run.residual, parameters, spline.axes()) : -1;
        if (sample < 0) {
            FitReport report = course.report(data, std::move(run.control));
            report.settings["insertions"] = static_cast<double>(insertions);
            if (const std::string note = unmoved(owner, controls); !note.empty())
                report.notes.push_back(note);
            if (run.insert) report.termination = Termination::stalled; // nothing is left to insert
            return {std::move(spline), parameters, std::move(report)};
        }
        for (std::size_t k = 0; k < axes.size(); ++k)
            if (const double t = parameters.scattered(sample, static_cast<Index>(k));
                !has_knot(spline.axis(k), t))
                spline = insert_knot(spline, static_cast<Index>(k), t);
    }
}

} // namespace batten
