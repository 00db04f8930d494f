#pragma once

#include <batten/search/curve_trial.hpp>

#include <vector>

namespace batten {

/// Rounds of settle() that a trial is worth when much depends on it.
inline constexpr int trial_rounds = 16;

/// Weights to start from: least squares in parts of each sample's tolerance, times the caller's
/// weights.
std::vector<double> first_weights(const CurveTask& task);

/// A trial on these knots before anything is solved: the task's parameters, first weights.
CurveTrial first_trial(const CurveTask& task, KnotVector knots);

/// Interior knots with their multiplicities: of a closed axis without the seam's.
std::vector<double> interior_knots(const KnotVector& knots);

/// Knots over the same domain with other interior ones.
KnotVector with_interior(const CurveTask& task, const KnotVector& old,
                         const std::vector<double>& interior);

/// Whether the seam of a closed curve is one of the corners.
bool seam_is_corner(const CurveTask& task);

/// Knots that the search keeps, ascending: of full multiplicity at corners, as many as its
/// continuity takes at a closed curve's seam.
std::vector<double> lasting_knots(const CurveTask& task);

/// Interior knots of a trial besides those that last.
std::size_t free_knots(const CurveTask& task, const CurveTrial& trial);

/// Whether interior knots are enough: a closed curve has degree + 1 control points at least.
bool makes_curve(const CurveTask& task, const std::vector<double>& interior);

/// Adds these to ascending others.
std::vector<double> with_lasting_knots(const CurveTask& task, std::vector<double> interior);

/// Few knots to start from, between the parameters on a closed curve, and those that last: as many
/// as the samples determine.
KnotVector first_knots(const CurveTask& task);

/// Part of what is allowed between samples that the trial uses, at most 1 being good.
double between(const CurveTask& task, const CurveTrial& trial);

/// Whether it uses too much of it to be handed out (wild_part); `looser`: of what tolerances so
/// many times the task's allow. What cannot be seen (unseen) is not wild however tight they are.
bool is_wild(const CurveTask& task, const CurveTrial& trial, double looser = 1);

} // namespace batten
