#pragma once

#include <batten/iterate/method.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace batten {

/// When the loop ends: any of these tests ends it; one of 0 is off. A gradient of exactly 0 always
/// ends it.
struct StopRule {
    Index max_iterations = 10000;
    /// Stop when the method's gradient norm is at most this.
    double gradient = 0;
    /// Stop when it is at most this times the method's reference norm.
    double relative_gradient = 1e-10;
    /// Stop when the largest deviation of a sample is at most this.
    double deviation = 0;
};

/// Throws InvalidInput unless every value is finite and not negative.
void check(const StopRule& stop);

/// Which tests of a stop rule hold.
struct StopTests {
    bool gradient = false;
    bool relative_gradient = false;
    bool deviation = false;

    bool any() const { return gradient || relative_gradient || deviation; }
};

/// How a fit ended.
enum class Termination {
    converged,         ///< a test of the stop rule held (a direct solution: always)
    iteration_limit,   ///< the most iterations allowed were made
    tolerance_met,     ///< every sample is within the stated tolerance
    tolerance_not_met, ///< it is not, and the report says why
    stalled,           ///< the moves vanished before one held
    breakdown,         ///< numbers left the finite range
    cancelled,         ///< the caller asked to stop
};

std::string_view to_string(Termination termination);

/// What an observer sees at every iteration, before the move.
struct Iteration {
    Index number;
    /// P^k, absolute; valid during the call.
    const PointSet& control;
    double gradient_norm;
    /// Length of the longest move made to get here, 0 at first.
    double largest_move;
    /// Sum of squared constraint errors; 0 without constraints.
    double constraint_error;
};

enum class Continue { yes, no };
using Observer = std::function<Continue(const Iteration&)>;

/// Shortens or turns the proposed moves so that a shape is kept: (control points, moves).
using StepLimit = std::function<void(const PointSet&, PointSet&)>;

/// Largest deviation of a sample from the spline with these control points, absolute ones.
using DeviationMeasure = std::function<double(const PointSet&)>;

/// Optional parts of the loop.
struct IterateHooks {
    Observer observer{};
    StepLimit limit{};
    DeviationMeasure deviation{}; ///< needed when StopRule::deviation is not 0
    /// What the loop's control points are relative to (dim); empty: to nothing.
    std::vector<double> centre{};
};

/// How the loop went.
struct Summary {
    Index iterations = 0;
    Termination termination = Termination::converged;
    /// The tests that held at the last control points; some did when, and only when, the run
    /// converged or only missed constraints kept it from that.
    StopTests held;
    double gradient_norm = 0;
    double first_gradient_norm = 0;
    /// What the relative gradient is relative to.
    double reference_norm = 0;
    /// Largest deviation of a sample at the last control points; absent unless
    /// StopRule::deviation asked for it.
    std::optional<double> deviation;
    /// Mean factor per iteration by which the gradient norm fell over the second half of the run; 0
    /// if too short.
    double observed_rate = 0;
};

/// Mean factor per iteration by which these gradient norms fall over the second half of a run; 0 of
/// fewer than 4, or where one of them is 0.
double observed_rate(const std::vector<double>& norms);

/// Moves `control` (N x dim) by the method until a test of the stop rule holds and so do the
/// method's constraints: the one loop of all methods. Throws InvalidInput for a stop rule that is
/// no such thing.
Summary iterate(Method& method, PointSet& control, const StopRule& stop,
                const IterateHooks& hooks = {});

} // namespace batten
