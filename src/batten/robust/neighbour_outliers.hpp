#pragma once

#include <batten/robust/neighbours.hpp>

namespace batten {

/// Samples of a sequence or grid that disagree with their neighbours along every axis: what those
/// predict that are most certain is further away than five to six standard deviations of noise,
/// than four times what the same polynomials are off beside the sample, and than `least` (one per
/// sample, infinite for one that stays).
///
/// Whatever is suspicious is left out first, together with what is beside it; then what the rest
/// explains comes back, the most certain first. Runs of four and more that go on smoothly stay, and
/// so does a bend or a corner that its neighbours do not know without it.
NeighbourOutliers neighbour_outliers(Trusted trusted, const std::vector<double>& least);

} // namespace batten
