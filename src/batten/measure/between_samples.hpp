#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>

#include <vector>

namespace batten {

/// Whether a spline does nothing odd between samples.
struct BetweenSamples {
    bool good = true;
    Index worst_sample = 0; ///< the first of the pair, or of the cell, with the greatest excess
    double excess = 0;      ///< largest part of what is allowed that is used: at most 1 when good
    Index loops = 0;        ///< of a planar curve between two consecutive samples; good has none
};

/// Between samples i and i + 1 a curve may stray from their segment by the greater of 2 T and the
/// sagitta of the circles through the neighbouring triples plus T, and may be 1.2 times their
/// distance + 4 T + the parts beyond long; T is the greater tolerance of the two. `parameters`
/// ascend; a closed curve's way from the last sample to the first counts, too.
BetweenSamples check_between(const Spline& curve, const Points& samples,
                             const std::vector<double>& parameters,
                             const std::vector<double>& tolerance);

/// Half-way between a grid's neighbouring samples, along edges and across faces and cells, the
/// spline may be off the mean of the samples around by the greater of 2 T and T plus, for each axis
/// between whose samples it is, 1/4 of the largest second difference there along it (twice what a
/// smooth surface through the samples has).
BetweenSamples check_between_grid(const Spline& spline, const Samples& samples,
                                  const Parameters& parameters,
                                  const std::vector<double>& tolerance);

} // namespace batten
