#include <batten/drivers/least_squares.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/iterate/clspia.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/problem/held.hpp>
#include <batten/problem/initial.hpp>
#include <batten/problem/plan.hpp>
#include <batten/problem/subset.hpp>
#include <batten/shape/polygon.hpp>
#include <batten/solve/cross_validation.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/factor_search.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/keep_shape.hpp>
#include <batten/solve/nested_cholesky.hpp>
#include <batten/solve/working_eigenvalues.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace batten {

namespace {

/// The space, the equalities and the normal equations of a sized problem.
struct Equations {
    std::vector<KnotVector> axes;
    std::unique_ptr<NormalSystem> system;
    Constraints held;  ///< relative to the system's centre
    double lambda = 0; ///< factor of the roughness in the system
};

/// Whether the samples reach every control point and leave no direction open.
bool determined(const NormalSystem& system) {
    if (!reaches_all(system)) return false;
    try {
        factorize(system);
    } catch (const SolverError&) {
        return false;
    }
    return true;
}

/// CLSPIA approximates the samples that are not held [ChangMaDeng2023, section 2]; where these do
/// not determine every control point, or roughness is weighed against them, all of them, which have
/// the same constrained minimum.
Equations assembled(const Problem& problem, std::string_view method) {
    Equations result{fixed_knots(problem), nullptr, Constraints(problem.samples.dim())};
    const HoldOptions& hold = problem.options.hold;
    const Constraints held =
        held_constraints(result.axes, problem.samples, problem.parameters, hold);
    if (method == "clspia" && !hold.interpolate.empty() && !problem.options.smooth.wanted) {
        std::vector<Index> exact = hold.interpolate;
        std::ranges::sort(exact);
        const Subset rest = Subset::without(exact, problem.samples.size());
        if (rest.size() == 0)
            throw InvalidInput("clspia: every sample is interpolated, none is left to approximate; "
                               "use method direct");
        result.system =
            assemble(result.axes, rest.of(problem.samples), rest.of(problem.parameters));
        if (!determined(*result.system)) result.system.reset();
    }
    if (!result.system) result.system = assemble(result.axes, problem.samples, problem.parameters);
    result.held = held.centred(result.system->centre());
    return result;
}

/// Whether the number of control points is this library's choice.
bool size_is_open(const Problem& problem) {
    return problem.options.shape.control_points.empty() && problem.options.shape.knots.empty();
}

/// Throws InvalidInput where a stated factor leaves nothing of the samples in rounded numbers.
void check_factor(const NormalSystem& system, const Problem& problem, std::string_view method) {
    const auto& [wanted, lambda, order] = problem.options.smooth;
    if (!wanted || lambda == 0) return;
    const bool rows = method == "direct" && !system.factors().empty() &&
                      problem.options.hold.preserve == Preserve::nothing;
    const double most = largest_factor(system, order, rows ? Solution::rows : Solution::entries);
    if (lambda > most)
        throw InvalidInput(
            fmt::format("smoothing by {}: the largest factor that method {} can tell "
                        "from an infinite one here is {:.2g}",
                        lambda, method, most));
}

/// The given or cross-validated smoothing; of a given one only the factor is known where nothing
/// else is asked.
Smoothing smoothing_of(const NormalSystem& system, const Problem& problem) {
    const auto& [wanted, lambda, order] = problem.options.smooth;
    if (!wanted) return {};
    if (lambda == 0) return cross_validated(system, problem.samples, problem.parameters, order);
    if (system.factors().empty() || !size_is_open(problem)) return {.lambda = lambda};
    return smoothed_by(lambda, system, problem.samples, problem.parameters, order);
}

/// The control points that a smooth spline needs where their number is open and larger: knots a
/// few times as dense as its kernel is wide [Silverman1984].
std::optional<std::vector<Index>> fewer_control_points(const Problem& problem,
                                                       const std::vector<double>& freedom) {
    constexpr double enough = 8; // per degree of freedom
    // what must hold may take all of them
    if (!size_is_open(problem) || freedom.empty() || problem.options.hold.equalities()) return {};
    std::vector<Index> result = problem.axes.control_points;
    for (std::size_t k = 0; k < result.size(); ++k)
        result[k] = std::min(result[k], static_cast<Index>(std::ceil(enough * freedom[k])) +
                                            problem.axes.degree[k]);
    if (result == problem.axes.control_points) return {};
    return result;
}

/// The direct answer whose polygon bends no more often than the initial one, or not at all.
Course solved_in_shape(const Equations& equations, const Problem& problem) {
    const HoldOptions& hold = problem.options.hold;
    const PointSet initial = initial_control(problem.samples, problem.parameters, equations.axes,
                                             problem.options.method);
    check_shape(hold.preserve, equations.axes, initial, "direct");
    const Index most = hold.preserve == Preserve::convexity
                           ? 0
                           : inflection_count(initial, equations.axes[0].closure(), kept_roundings);
    Course course{solve_with_inflections(*equations.system, equations.held, most), {}};
    course.report.allowed_inflections = most;
    return course;
}

std::unique_ptr<Method> iteration_for(const Equations& equations, const Problem& problem,
                                      std::string_view method) {
    const Settings& s = problem.options.method.settings;
    const NormalSystem& system = *equations.system;
    if (method != "clspia") return make_method(method, system, s);
    const MethodEntry& entry = method_entry("clspia");
    if (problem.options.hold.preserve != Preserve::nothing && setting(entry, s, "warm_start") > 0)
        throw InvalidInput("clspia: warm_start moves the control points before a shape is kept; "
                           "leave one of them out");
    const Constraints exact = with_best_lengths(system, equations.held.independent(system.size()));
    return std::make_unique<Clspia>(
        system, exact, exactness * problem.size,
        ClspiaSettings{setting(s, "mu"), setting(s, "mu_1"), stated_row_sums(s),
                       setting(s, "inner_tolerance"), setting(entry, s, "eigenvalue_tolerance"),
                       setting(entry, s, "lambda"),
                       static_cast<Index>(setting(entry, s, "warm_start")), exactness});
}

Course iterated_from_start(const Equations& equations, const Problem& problem,
                           std::string_view name) {
    const NormalSystem& system = *equations.system;
    const auto method = iteration_for(equations, problem, name);
    const PointSet start = initial_control(problem.samples, problem.parameters, equations.axes,
                                           problem.options.method);
    if (problem.options.method.before.size() > 0)
        method->resume(moves_before(problem.samples.dim(), equations.axes, problem.options.method));
    const DeviationMeasure deviation = [&](const PointSet& control) {
        const Spline now = Spline::from_free(equations.axes, control);
        return summarise(parametric_deviations(now, problem.samples, problem.parameters),
                         DeviationKind::parametric)
            .maximum;
    };
    return iterated(*method, {centred(start, system.centre()), system.centre()}, equations.axes,
                    problem.options, deviation);
}

SampleRows sample_rows(const Equations& equations, const Problem& problem) {
    return {problem.samples, problem.parameters, equations.lambda, problem.options.smooth.order};
}

struct SquaredResiduals {
    double weighted = 0; ///< their sum
    double weights = 0;  ///< theirs
};

SquaredResiduals squared_residuals(const Spline& spline, const Problem& problem) {
    const std::vector<double> away =
        parametric_deviations(spline, problem.samples, problem.parameters);
    const std::vector<double>& weights = problem.samples.weights;
    SquaredResiduals sum;
    for (std::size_t i = 0; i < away.size(); ++i) {
        const double weight = weights.empty() ? 1 : weights[i];
        sum.weighted += weight * away[i] * away[i];
        sum.weights += weight;
    }
    return sum;
}

/// Standard deviation of a sample of mean weight that a spline of such freedom leaves.
double noise_of(const Spline& spline, const Problem& problem, double freedom) {
    const auto [squares, total] = squared_residuals(spline, problem);
    return noise_left(squares / total, static_cast<double>(problem.samples.size()), freedom);
}

Course answered(const Equations& equations, const Problem& problem, std::string_view method) {
    if (method != "direct") return iterated_from_start(equations, problem, method);
    if (problem.options.hold.preserve != Preserve::nothing)
        return solved_in_shape(equations, problem);
    Course course{solve_direct(*equations.system, sample_rows(equations, problem), equations.held),
                  {}};
    course.report.gradient_norm = frobenius_norm(equations.system->gradient(course.control));
    return course;
}

/// By how much the functional is above its least value, in parts of it; -1 where that would cost
/// more than the iteration. `samples`: the system without roughness.
double above_minimum(const Equations& equations, const NormalSystem& samples,
                     const Problem& problem, const PointSet& control) {
    const NormalSystem& system = *equations.system;
    const std::size_t axes = equations.axes.size();
    if (axes > 1 && system.factors().empty() && system.size() > most_dissected(axes)) return -1;
    PointSet least;
    try {
        least = solve_direct(system, sample_rows(equations, problem), equations.held);
    } catch (const SolverError&) {
        return -1;
    }
    PointSet image(least);
    const auto energy = [&](const NormalSystem& of, const PointSet& x) {
        of.apply(x, image);
        return inner_product(x, image);
    };
    const double roughness = energy(system, least) - energy(samples, least);
    const Spline spline = Spline::from_free(equations.axes, uncentred(least, system.centre()));
    const double functional =
        squared_residuals(spline, problem).weighted + std::max(0.0, roughness);
    PointSet off(control);
    add_scaled(off, -1, least);
    return functional > 0 ? energy(system, off) / functional : 0;
}

/// Whether an iteration ended as it does when nothing else is asked for.
bool to_the_end(const FitReport& report, const Problem& problem) {
    return report.termination == Termination::converged &&
           problem.options.stop.relative_gradient == StopRule().relative_gradient &&
           problem.options.stop.gradient == 0 && problem.options.stop.deviation == 0 &&
           !problem.options.hold.equalities() && problem.options.hold.preserve == Preserve::nothing;
}

} // namespace

Fitted fit_least_squares(const Problem& problem, std::string_view method) {
    Stopwatch watch;
    Equations equations = assembled(problem, method);
    problem.stop_if_cancelled();
    const double assemble_seconds = watch.lap();
    check_factor(*equations.system, problem, method);
    const Smoothing smoothing = smoothing_of(*equations.system, problem);
    if (const auto fewer = fewer_control_points(problem, smoothing.axis_freedom)) {
        Problem smaller = problem;
        smaller.axes.control_points = *fewer;
        smaller.options.shape.control_points = *fewer;
        Fitted fitted = fit_least_squares(smaller, method);
        fitted.report.seconds[1].second += assemble_seconds + watch.lap();
        return fitted;
    }
    const auto samples = smoothing.lambda > 0 ? equations.system->clone() : nullptr;
    if (samples) equations.system->add_roughness(smoothing.lambda, problem.options.smooth.order);
    equations.lambda = smoothing.lambda;
    const double smoothing_seconds = watch.lap();
    Course course = answered(equations, problem, method);
    FitReport& report = course.report;
    report.method = method;
    report.smoothing = smoothing.lambda;
    if (samples && method != "direct" && to_the_end(report, problem))
        report.above_minimum = above_minimum(equations, *samples, problem, course.control);
    report.seconds = {{"assemble", assemble_seconds}, {"solve", watch.lap()}};
    if (problem.options.smooth.wanted)
        report.seconds.insert(report.seconds.begin() + 1, {"smoothing", smoothing_seconds});
    Spline spline =
        Spline::from_free(equations.axes, uncentred(course.control, equations.system->centre()));
    if (smoothing.lambda > 0 && problem.options.smooth.lambda == 0) {
        report.freedom =
            smoothing.freedom - freedom_held(*samples, *equations.system,
                                             sample_rows(equations, problem), equations.held);
        report.noise_level =
            equations.held.empty() ? smoothing.noise : noise_of(spline, problem, report.freedom);
    }
    return {std::move(spline), problem.parameters, std::move(report)};
}

} // namespace batten
