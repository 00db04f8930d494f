#pragma once

#include <batten/core/vectors.hpp>
#include <batten/problem/options.hpp>
#include <batten/spline/spline.hpp>
#include <batten/system/constraints.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace batten {

/// What a curve must reach: samples in order, a tolerance for each, and what must hold exactly.
struct CurveTask {
    const Samples& samples;
    std::vector<double> tolerance; ///< one per sample, positive
    int degree = 3;
    Closure closure = Closure::open;
    HoldOptions hold{};
    /// Inflections that the control polygon may have; negative: any number.
    Index most_inflections = -1;
    /// What it may turn in all where these are limited, in radians: one that folds back on itself
    /// has none.
    double most_turning = std::numeric_limits<double>::infinity();
    /// Factor of the roughness (NormalSystem::add_roughness, order 2) that keeps in rein what no
    /// sample holds; 0: none.
    double roughness = 0;
    /// Parameters that follow from the data alone; the corrected ones may have been led astray by a
    /// coarse curve.
    std::vector<double> parameters{};
    /// Samples that are corners: a knot of full multiplicity each, at the sample's parameter, which
    /// stays.
    std::vector<Index> corners{};
    /// Order up to which derivatives agree at a closed curve's seam; degree - 1 is no condition.
    int seam_continuity = max_degree;
    /// Whether C1 or more was asked for: then the seam is no corner.
    bool seam_stated = false;
    /// Samples where the direction jumps, as all show it whose part these are; unset: not known
    /// beforehand.
    std::optional<std::vector<Index>> sharp{};
    /// Number of all samples whose part these are; 0: these are all.
    Index stand_for = 0;
    /// Samples whose parameters stay, ascending: corners, the seam, those with a tangent.
    std::vector<Index> fixed{};
    /// Greatest part of what is allowed between samples (measure/between_samples.hpp) that a
    /// thinner or risen curve may use.
    double between = 1;
    /// FitOptions::unit, for words.
    double unit = 1;
    /// Asked every round; true ends the search with Cancelled.
    std::function<bool()> cancelled{};
};

/// The number of samples, or of those that they stand for.
inline Index samples_in_all(const CurveTask& task) {
    return task.stand_for > 0 ? task.stand_for : task.samples.size();
}

/// The smallest of its tolerances.
inline double tightest(const CurveTask& task) {
    return *std::min_element(task.tolerance.begin(), task.tolerance.end());
}

/// The task with its tolerances times a factor.
inline CurveTask with_tolerances(CurveTask task, double factor) {
    scale(task.tolerance, factor);
    return task;
}

/// A curve on the way: knots, parameters and weights of the samples, and how far it is from its
/// goal.
struct CurveTrial {
    KnotVector knots;
    std::vector<double> parameters;
    std::vector<double> weights;
    PointSet control;          ///< free control points
    std::vector<double> ratio; ///< distance over tolerance, per sample
    std::string conflict;      ///< why what must hold could not on the last knots tried
    double worst = 0;          ///< the largest of these; above 1, too, when the shape is not kept
};

/// Whether `settle` may shift knots towards where the error is.
enum class KnotShift { none, allowed };

/// How `settle` goes about it: by the samples' distances at their parameters, given up where the
/// weights will hardly bring them within tolerance; or by those across the curve
/// (search/curve_across.hpp) as long as it comes nearer.
enum class Effort { quick, thorough };

/// Least-squares fit on the trial's knots, with parameters corrected by one closest-point step a
/// round (in order, never past a neighbour's half-way) and weights moved towards the samples that
/// are furthest out (Lawson's iteration), for at most `rounds` rounds or until every sample is
/// within tolerance. Leaves the best round's state. Returns whether the tolerance is met. Throws
/// SolverError when the samples do not determine the control points.
bool settle(const CurveTask& task, CurveTrial& trial, int rounds, KnotShift shift,
            Effort effort = Effort::quick);

/// Makes a trial with control points one of these samples: so many steps of correction, distances.
/// A sample that its neighbours keep from its closest point has the distance of that one.
void follow(const CurveTask& task, CurveTrial& trial, int corrections);

/// Limits a planar curve's inflections, and with them what it may turn in all: half a turn further
/// than its samples. Negative: any number.
void limit_inflections(CurveTask& task, Index most);

/// Whether the control polygon bends no more often, and turns no further, than it may.
bool shape_kept(const CurveTask& task, const CurveTrial& trial);

/// The trial as a spline.
Spline spline_of(const CurveTrial& trial);

} // namespace batten
