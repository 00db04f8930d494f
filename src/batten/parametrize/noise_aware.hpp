#pragma once

#include <batten/parametrize/parametrize.hpp>

namespace batten {

/// Parameters by chord length of a noisy sequence: of running means over so many samples that the
/// noise is a small part of their steps; the plain ones where there is little noise.
std::vector<double> noise_aware_parameters(const Points& sequence, Closure closure);

} // namespace batten
