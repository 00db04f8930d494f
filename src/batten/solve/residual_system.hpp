#pragma once

#include <batten/system/normal_system.hpp>

#include <memory>

namespace batten {

/// The normal system of what a spline leaves of the samples.
std::unique_ptr<NormalSystem> residual_system(const Spline& spline,
                                              const std::vector<KnotVector>& axes,
                                              const Samples& samples, const Parameters& parameters);

} // namespace batten
