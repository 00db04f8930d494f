#pragma once

#include <batten/system/normal_system.hpp>

namespace batten {

/// What generalised cross-validation chose.
struct Smoothing {
    double lambda = 0;
    double freedom = 0; ///< trace of the matrix that makes fitted values of the samples
    double noise = 0;   ///< standard deviation of a sample that is left, all coordinates together
};

/// The lambda with the least V = (RSS / m) / (1 - trace / m)^2 [CravenWahba1979] for the assembled
/// system of m samples; multiplying the data by a factor changes nothing in it. For scattered
/// samples the trace is estimated from fixed random vectors [Hutchinson1990]. Throws SolverError
/// when no lambda gives a solvable system.
Smoothing cross_validated(const NormalSystem& system, int order);

} // namespace batten
