#pragma once

#include <batten/core/core.hpp>
#include <batten/spline/spline.hpp>

#include <vector>

namespace batten {

/// Whether a curve does nothing odd between samples, judged between the points at consecutive
/// samples' parameters.
struct BetweenSamples {
    bool good = true;
    Index worst_sample = 0; ///< the first of the pair with the greatest excess
    double excess = 0;      ///< largest part of what is allowed that is used: at most 1 when good
};

/// Between samples i and i + 1 the curve may stray from their segment by the greater of 2 T and the
/// sagitta of the circles through the neighbouring triples plus T, and may be 1.2 times their
/// distance + 4 T + the parts beyond long; T is the greater tolerance of the two. `parameters`
/// ascend; a closed curve's way from the last sample to the first counts, too.
BetweenSamples check_between(const Spline& curve, const Points& samples,
                             const std::vector<double>& parameters,
                             const std::vector<double>& tolerance);

} // namespace batten
