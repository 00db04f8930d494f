#pragma once

#include <batten/search/curve_refining.hpp>

#include <optional>

namespace batten {

/// Whether a curve may have as many control points as samples.
bool may_go_through(const CurveTask& task, const ToleranceOptions& options);

/// What is handed out where the search (search/curve_fewest.hpp) has missed the task's tolerances:
/// the closest acceptable curve that it, one at looser tolerances or one with a little roughness
/// counted has seen; failing any, what was acceptable at the least loose of these, or what the
/// search left. Looser tolerances than `reached` times the task's are not tried. It may be `met`
/// after all.
CurveWithin closest_curve(const CurveTask& task, const ToleranceOptions& options, Index most,
                          const CurveWithin& found, double reached);

/// Knots for a curve through every sample: the means of degree consecutive parameters in each piece
/// between lasting knots (averaged_knots), of a smooth closed curve knots_at_parameters. Nothing
/// where a held seam is no sample's parameter or a piece has too few samples.
std::optional<KnotVector> knots_through(const CurveTask& task);

/// The last resort: the curve through every sample, of few samples thinned out within the
/// tolerances. `met` says that it is within them and tame enough to be handed out; a trial without
/// control points that there is none. Tangents and a kept shape may keep it from the samples.
CurveWithin curve_through(const CurveTask& task);

} // namespace batten
