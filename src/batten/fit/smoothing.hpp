#pragma once

#include <batten/fit/options.hpp>
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

/// The given or cross-validated smoothing, entered into the system.
Smoothing add_smoothing(NormalSystem& system, const SmoothOptions& options);

/// Parameters by chord length of a noisy sequence: of running means over so many samples that the
/// noise is a small part of their steps; the plain ones where there is little noise.
std::vector<double> noise_aware_parameters(const Points& sequence, Closure closure);

/// Control points per axis when smoothing rules the detail and their number does not: enough to
/// follow the samples.
std::vector<Index> smoothing_size(const Samples& samples, const ShapeOptions& shape);

} // namespace batten
