#pragma once

#include <batten/search/curve_trial.hpp>

#include <vector>

namespace batten {

inline constexpr int evenly = -1; ///< in place of passes of smoothing: knots at equal distances

/// `count` interior knots spread so that each span gets an equal part of |f^(p+1)|^(1/(p+1)),
/// estimated from the jumps of the highest derivative [deBoor1978, chapter XII], which are noisy:
/// `smoothing` passes of averaging with the neighbours; or evenly.
std::vector<double> spread(const CurveTask& task, const CurveTrial& trial, std::size_t count,
                           int smoothing);

} // namespace batten
