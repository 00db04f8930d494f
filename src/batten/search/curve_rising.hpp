#pragma once

#include <batten/search/curve_refining.hpp>

namespace batten {

/// Another way to few knots than refining and thinning out: from the fewest upwards, at most `most`
/// control points, spread anew each time (`smoothing` as in search/curve_spread.hpp), the samples'
/// parameters following the curve from one count to the next. `met` when every sample is within
/// tolerance and the curve strays no further between them than CurveTask::between allows. Bounded
/// in trials.
CurveWithin risen(const CurveTask& task, Index most, int smoothing);

/// Takes out knots as long as the rest, spread anew or shifted, still meets the tolerance and does
/// nothing odd. Bounded in trials.
void squeeze(const CurveTask& task, CurveWithin& fit);

} // namespace batten
