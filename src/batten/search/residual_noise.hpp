#pragma once

#include <batten/core/core.hpp>

namespace batten {

/// Standard deviation of the noise of a sequence, of the whole vector: what a cubic least-squares
/// curve leaves that has at least 16 samples per span and residuals that change direction from one
/// sample to the next as often as chance would have it; where only what lies across the curve has
/// such residuals, that of 128 samples or more. 0 where no such curve is adequate: the samples are
/// fewer than 64 or what is left has a course of its own, so nothing is known of their noise.
double residual_noise(const Points& sequence);

} // namespace batten
