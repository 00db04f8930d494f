#pragma once

#include <batten/system/normal_system.hpp>

#include <memory>

namespace batten {

/// The normal system of what a spline leaves of the samples.
std::unique_ptr<NormalSystem> residual_system(const Spline& spline,
                                              const std::vector<KnotVector>& axes,
                                              const Samples& samples, const Parameters& parameters);

/// What control points leave of the samples.
struct Residuals {
    PointSet pulls;     ///< A^T D r (N x dim)
    double squares = 0; ///< weighted, summed
};

/// Control points relative to the system's centre, of the samples that it was assembled of.
Residuals residuals_of(const PointSet& control, const NormalSystem& system, const Samples& samples,
                       const Parameters& parameters);

} // namespace batten
