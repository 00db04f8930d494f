#pragma once

#include <batten/search/curve_trial.hpp>
#include <batten/spline/curve_pieces.hpp>

namespace batten {

/// Coordinates of the samples that solve_across takes at most: its equations couple them.
inline constexpr Index most_coordinates = 4;

/// Whether a sample's parameter stays while those of the others follow the curve: the ends of an
/// open curve and the samples that the task fixes.
bool parameter_stays(const CurveTask& task, Index sample);

/// Free control points (n x dim) of the least-squares fit on the trial's knots that counts each
/// sample's distance across the curve `last`, and of that along it a part: the nearer the sample
/// for the curve's bend, the smaller. A step of squared distance minimisation
/// [WangPottmannLiu2006]. `exact` must hold: positions relative to the first sample. Throws
/// SolverError when the samples do not determine the control points, ConstraintConflict as
/// Constraints::independent does.
PointSet solve_across(const CurveTask& task, const CurveTrial& trial, const CurvePieces& last,
                      const Constraints& exact);

} // namespace batten
