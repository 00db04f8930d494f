#pragma once

#include <batten/search/curve_refining.hpp>

namespace batten {

/// The whole search for a curve with few control points, at most `most`: refined, with corners or
/// without, thinned out, searched again where it is wild or bends more often than its samples.
/// `met` says that it is acceptable, too. The corners found are entered in the task.
CurveWithin fewest_knots(CurveTask& task, const ToleranceOptions& options, Index most);

/// The best smooth curve for samples with a known level of noise: within what the noise's extremes
/// ask for, where `met`.
CurveWithin smooth_curve(const CurveTask& task, double noise, Index most);

} // namespace batten
