#include <batten/search/curve_trial.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/core/vectors.hpp>
#include <batten/problem/held.hpp>
#include <batten/search/curve_across.hpp>
#include <batten/shape/polygon.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/keep_shape.hpp>
#include <batten/spline/curve_pieces.hpp>
#include <batten/system/collocation.hpp>
#include <batten/system/factored_system.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

namespace batten {

namespace {

constexpr Index few_exact = 40; // constraints: their dense equations cost little

/// Control points on the trial's knots: of the samples' distances at their parameters, or across
/// the curve of the round before where there is one and nothing but positions must hold.
PointSet solve(const CurveTask& task, const CurveTrial& trial, const CurvePieces* last) {
    const auto origin = task.samples.points[0];
    const std::vector<double> centre(origin.begin(), origin.end());
    Constraints exact(task.samples.dim());
    if (task.hold.equalities())
        exact = held_constraints({trial.knots}, task.samples, {{trial.parameters}, {}}, task.hold)
                    .centred(centre);
    const bool across = last && task.samples.dim() > 1 && task.samples.dim() <= most_coordinates &&
                        task.most_inflections < 0 && exact.directions().empty() &&
                        exact.size() <= few_exact;
    if (across) return solve_across(task, trial, *last, exact);
    BandedSystem system(trial.knots, centre);
    system.add(trial.parameters, task.samples.points, trial.weights);
    if (task.roughness > 0) system.add_roughness(task.roughness, 2);
    const PointSet control = task.most_inflections >= 0
                                 ? solve_with_inflections(system, exact, task.most_inflections)
                                 : solve_direct(system, exact);
    return uncentred(control, centre);
}

/// Makes the samples that must be hit look far out, so that knots go to them.
void mark_held(const CurveTask& task, CurveTrial& trial) {
    std::ranges::fill(trial.ratio, 0.0);
    for (Index i : task.hold.interpolate) trial.ratio[static_cast<std::size_t>(i)] = 10;
    for (const HeldTangent& tangent : task.hold.tangents)
        trial.ratio[static_cast<std::size_t>(tangent.sample)] = 10;
}

constexpr double misshapen = 1.25; // stands for a distance that is not reached

constexpr Index samples_at_once = 1 << 15; // fewer are done sooner than a thread is called

/// The Gauss-Newton step from a place of the curve towards its closest point to a sample; 0 where
/// the curve stands still.
double step_towards(const CurvePoint& at, std::span<const double> sample) {
    double slope = 0;
    double curvature = 0;
    double bend = 0;
    for (std::size_t d = 0; d < sample.size(); ++d) {
        const double gap = sample[d] - at.point[d];
        slope += gap * at.first[d];
        curvature += at.first[d] * at.first[d];
        bend += gap * at.second[d];
    }
    if (!(curvature > 0)) return 0;
    const double hessian = curvature - bend;
    return slope / (hessian > 0.3 * curvature ? hessian : curvature);
}

double distance_to(const CurvePoint& at, std::span<const double> sample) {
    return distance(sample, std::span(at.point).first(sample.size()));
}

/// One step of each sample's parameter towards its closest point, kept in order.
void correct_parameters(const CurveTask& task, const CurvePieces& pieces, CurveTrial& trial) {
    const std::vector<double> old = trial.parameters;
    std::vector<double>& t = trial.parameters;
    const std::size_t m = t.size();
    const bool open = task.closure == Closure::open;
    for_each_block(task.samples.size(), samples_at_once, [&](const Block& block) {
        for (Index k = block.begin; k < block.end; ++k) {
            if (parameter_stays(task, k)) continue;
            const auto i = static_cast<std::size_t>(k);
            const double step = step_towards(pieces(old[i]), task.samples.points[k]);
            const double low =
                i > 0 ? (old[i - 1] + old[i]) / 2 : (open ? old[i] : trial.knots.begin());
            const double high =
                i + 1 < m ? (old[i] + old[i + 1]) / 2 : (open ? old[i] : trial.knots.end());
            t[i] = std::clamp(old[i] + step, std::min(low, old[i]), std::max(high, old[i]));
        }
    });
}

/// The largest of the ratios, of a trial whose shape is not kept more than 1.
void judge(const CurveTask& task, CurveTrial& trial) {
    trial.worst = 0;
    for (double r : trial.ratio) trial.worst = std::max(trial.worst, r);
    if (!shape_kept(task, trial)) trial.worst = std::max(trial.worst, misshapen);
    if (!std::isfinite(trial.worst)) trial.worst = std::numeric_limits<double>::infinity();
}

void measure(const CurveTask& task, const CurvePieces& pieces, CurveTrial& trial) {
    for_each_block(task.samples.size(), samples_at_once, [&](const Block& block) {
        for (Index k = block.begin; k < block.end; ++k) {
            const auto i = static_cast<std::size_t>(k);
            trial.ratio[i] = distance_to(pieces(trial.parameters[i]), task.samples.points[k]) /
                             task.tolerance[i];
        }
    });
    judge(task, trial);
}

/// Gives samples out of tolerance the distance of a place beside theirs, nearer than their
/// neighbours would let them come.
void measure_beside(const CurveTask& task, const CurvePieces& pieces, CurveTrial& trial) {
    constexpr int most_steps = 12;
    for_each_block(task.samples.size(), samples_at_once, [&](const Block& block) {
        for (Index k = block.begin; k < block.end; ++k) {
            const auto i = static_cast<std::size_t>(k);
            if (trial.ratio[i] <= 1 || parameter_stays(task, k)) continue;
            double t = trial.parameters[i];
            for (int step = 0; step < most_steps && trial.ratio[i] > 1; ++step) {
                t = std::clamp(t + step_towards(pieces(t), task.samples.points[k]),
                               trial.knots.begin(), trial.knots.end());
                trial.ratio[i] =
                    std::min(trial.ratio[i],
                             distance_to(pieces(t), task.samples.points[k]) / task.tolerance[i]);
            }
        }
    });
    judge(task, trial);
}

/// Lawson's iteration, damped: a sample's weight follows its part of the largest error.
void reweigh(CurveTrial& trial) {
    double total = 0;
    for (std::size_t i = 0; i < trial.weights.size(); ++i) {
        trial.weights[i] *= 0.25 + trial.ratio[i] / trial.worst;
        total += trial.weights[i];
    }
    const double scale = static_cast<double>(trial.weights.size()) / total;
    for (double& w : trial.weights) w = std::max(1e-8, w * scale);
}

/// Shifts knots so that spans with more error get shorter: the spans' lengths follow error^(-1 /
/// (degree + 1)), half-way.
void shift_knots(const CurveTask& task, CurveTrial& trial) {
    const std::vector<double> breaks = trial.knots.breakpoints();
    if (breaks.size() < 3 ||
        static_cast<Index>(breaks.size()) - 1 != trial.knots.control_count() - task.degree)
        return; // multiple knots mark corners: they stay
    std::vector<double> error(breaks.size() - 1, 0);
    std::size_t span = 0;
    for (std::size_t i = 0; i < trial.parameters.size(); ++i) {
        while (span + 1 < error.size() && trial.parameters[i] >= breaks[span + 1]) ++span;
        error[span] = std::max(error[span], trial.ratio[i]);
    }
    constexpr double relaxation = 0.5;
    std::vector<double> length;
    double total = 0;
    for (std::size_t s = 0; s < error.size(); ++s) {
        const double part = std::clamp(error[s] / trial.worst, 0.05, 1.0);
        length.push_back((breaks[s + 1] - breaks[s]) *
                         std::pow(part, -relaxation / (task.degree + 1)));
        total += length.back();
    }
    std::vector<double> interior;
    double at = breaks.front();
    for (std::size_t s = 0; s + 1 < length.size(); ++s) {
        at += length[s] / total * (breaks.back() - breaks.front());
        interior.push_back(at);
    }
    const KnotVector moved =
        knots_around(task.degree, interior, breaks.front(), breaks.back(), task.closure);
    if (!undetermined(moved, trial.parameters)) trial.knots = moved;
}

} // namespace

void follow(const CurveTask& task, CurveTrial& trial, int corrections) {
    const CurvePieces pieces(trial.knots, trial.control);
    trial.ratio.resize(trial.parameters.size());
    for (int k = 0; k < corrections; ++k) correct_parameters(task, pieces, trial);
    measure(task, pieces, trial);
    if (trial.worst > 1) measure_beside(task, pieces, trial);
}

bool settle(const CurveTask& task, CurveTrial& trial, int rounds, KnotShift shift, Effort effort) {
    constexpr int most_idle = 8; // rounds in a row that do not bring it nearer
    const bool thorough = effort == Effort::thorough;
    std::optional<CurvePieces> last;
    int best_round = 0;
    CurveTrial best;
    best.worst = std::numeric_limits<double>::infinity();
    for (int round = 0; round < rounds; ++round) {
        if (task.cancelled && task.cancelled()) throw Cancelled("the fit was cancelled");
        try {
            trial.control = solve(task, trial, thorough && last ? &*last : nullptr);
        } catch (const SolverError&) { // samples crowd at one side of a span
            trial.worst = std::numeric_limits<double>::infinity();
            break;                                     // the round before stands
        } catch (const ConstraintConflict& conflict) { // too few knots where something must hold
            trial.conflict = conflict.what();
            trial.worst = std::numeric_limits<double>::infinity();
            mark_held(task, trial);
            break;
        }
        last.emplace(trial.knots, trial.control);
        correct_parameters(task, *last, trial);
        measure(task, *last, trial);
        if (trial.worst < best.worst) {
            best = trial;
            best_round = round;
        }
        if (trial.worst <= 1 || !std::isfinite(trial.worst)) break;
        const bool hopeless = (round >= 3 && best.worst > 4) || (round >= 7 && best.worst > 1.5);
        if (thorough ? round - best_round > most_idle : hopeless) break;
        if (round >= 2) reweigh(trial);
        if (shift == KnotShift::allowed && round % 2 == 1) shift_knots(task, trial);
    }
    if (std::isfinite(best.worst))
        trial = std::move(best);
    else
        trial.worst = best.worst;
    return trial.worst <= 1;
}

void limit_inflections(CurveTask& task, Index most) {
    task.most_inflections = most;
    if (most >= 0)
        task.most_turning =
            total_turning(PointSet(task.samples.points), task.closure) + std::numbers::pi;
}

bool shape_kept(const CurveTask& task, const CurveTrial& trial) {
    return task.most_inflections < 0 ||
           (inflection_count(trial.control, task.closure) <= task.most_inflections &&
            total_turning(trial.control, task.closure) <= task.most_turning);
}

Spline spline_of(const CurveTrial& trial) {
    return Spline::from_free({trial.knots}, trial.control);
}

} // namespace batten
