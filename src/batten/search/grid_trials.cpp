#include <batten/search/grid_trials.hpp>

#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/problem/held.hpp>
#include <batten/search/search.hpp>
#include <batten/solve/direct.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr double reachable = 2.5; // times the tolerance: beyond it pushing does not help

/// Directly on a grid; on a cloud by preconditioned conjugate gradients, which hold still what no
/// sample reaches.
PointSet solve(const GridTask& task, const NormalSystem& system) {
    if (task.hold.equalities())
        return solve_direct(
            system, held_constraints(system.axes(), task.samples, task.parameters, task.hold)
                        .centred(system.centre()));
    if (!task.parameters.is_scattered()) return solve_direct(system);
    PointSet control(system.size(), system.dim());
    ConjugateGradients cg(system, Preconditioner::axes);
    iterate(cg, control, {.max_iterations = 300, .relative_gradient = 1e-9});
    return control;
}

} // namespace

GridFit measured(const GridTask& task, Spline spline) {
    GridFit fit{std::move(spline), {}, 0};
    fit.ratio = parametric_deviations(fit.spline, task.samples, task.parameters);
    for (std::size_t i = 0; i < fit.ratio.size(); ++i) {
        fit.ratio[i] /= task.tolerance[i];
        fit.worst = std::max(fit.worst, fit.ratio[i]);
    }
    return fit;
}

GridFit least_squares(const GridTask& task, const std::vector<KnotVector>& axes,
                      const Samples& goals) {
    const auto system = assemble(axes, goals, task.parameters);
    return measured(task,
                    Spline::from_free(axes, uncentred(solve(task, *system), system->centre())));
}

GridTrials::GridTrials(const GridTask& task, std::vector<Spread> spreads)
    : task_(task), spreads_(std::move(spreads)), ascending_(ascending(task.parameters)) {}

double GridTrials::operator()(const std::vector<Index>& n) {
    auto& known = known_[effort == Effort::equalised ? 1 : 0];
    const auto found = known.find(n);
    return found != known.end() ? found->second : known[n] = attempt(n);
}

double GridTrials::attempt(const std::vector<Index>& n) {
    if (task_.cancelled && task_.cancelled()) throw Cancelled("the fit was cancelled");
    std::vector<KnotVector> axes;
    for (std::size_t k = 0; k < n.size(); ++k) {
        axes.push_back(knots_for_boundaries(
            knots_by(spreads_[k], ascending_[k], task_.degree[k], n[k], task_.closures[k]),
            static_cast<int>(k), task_.hold.boundaries));
        if (axes.back().free_count() > n[k]) // the boundaries alone have more
            return std::numeric_limits<double>::infinity();
        if (!task_.parameters.is_scattered() && undetermined(axes.back(), ascending_[k]))
            return std::numeric_limits<double>::infinity();
    }
    try {
        GridFit trial = least_squares(task_, axes, task_.samples);
        if (effort == Effort::equalised && trial.worst > 1 && trial.worst < reachable)
            equalise(axes, trial);
        const double wildness = between(trial);
        if (wildness <= 1) keep(GridIndex(n).size(), trial);
        return std::max(trial.worst, wildness);
    } catch (const SolverError&) {
        return std::numeric_limits<double>::infinity();
    } catch (const ConstraintConflict& error) { // with more control points it may hold
        conflict = error.what();
        return std::numeric_limits<double>::infinity();
    }
}

void GridTrials::equalise(const std::vector<KnotVector>& axes, GridFit& best_trial) const {
    constexpr int rounds = 16;
    constexpr double calm = 0.7; // part of the tolerance below which a sample is left alone
    constexpr double push = 1;
    Samples goals = task_.samples;
    PointSet moved(task_.samples.points);
    GridFit trial = best_trial;
    std::vector<double> course{trial.worst};
    for (int round = 0; round < rounds && best_trial.worst > 1; ++round) {
        const PointSet now = evaluate_grid(trial.spline, task_.parameters.axes);
        for (Index i = 0; i < moved.size(); ++i) {
            const double part = trial.ratio[static_cast<std::size_t>(i)];
            if (part <= calm) continue;
            const double factor = push * std::min(1.0, (part - calm) / (1 - calm));
            for (Index d = 0; d < moved.dim(); ++d)
                moved(i, d) += factor * (task_.samples.points(i, d) - now(i, d));
        }
        goals.points = Points(moved);
        trial = least_squares(task_, axes, goals);
        if (trial.worst < best_trial.worst) best_trial = trial;
        course.push_back(best_trial.worst);
        // three rounds must take a quarter off the excess
        const std::size_t before = course.size() > 4 ? course.size() - 4 : 0;
        if (round >= 3 && course.back() - 1 > 0.75 * (course[before] - 1)) break;
    }
}

double GridTrials::between(const GridFit& trial) const {
    if (task_.between == GridTask::Between::left_aside || !std::isfinite(trial.worst)) return 0;
    return check_reached(task_, trial.spline, trial.worst).excess / wild_part;
}

void GridTrials::keep(Index count, GridFit& trial) {
    const bool within = trial.worst <= 1;
    if (met ? !within || count >= fewest : !within && trial.worst >= best_worst) return;
    met = within;
    fewest = count;
    best_worst = trial.worst;
    best = std::move(trial.spline);
}

} // namespace batten
