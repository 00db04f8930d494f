#pragma once

#include <batten/solve/sample_rows.hpp>

namespace batten {

/// What generalised cross-validation chose.
struct Smoothing {
    double lambda = 0;
    double freedom = 0; ///< trace of the matrix that makes fitted values of the samples
    std::vector<double> axis_freedom{}; ///< along each axis, where freedom is their product
    double noise = 0; ///< standard deviation that is left of a sample whose weight is the mean
                      ///< one, all coordinates together
};

/// Standard deviation of one of m samples, of the mean weight, where a fit with so much freedom
/// leaves this (weighted) mean square.
double noise_left(double mean_square, double m, double freedom);

/// The lambda with the least V = (RSS / m) / (1 - trace / m)^2 [CravenWahba1979] for the m samples
/// that the system was assembled of: between one that leaves all freedom and one that leaves only
/// polynomials, to where V is as large a factor of root two to both sides. Neither the data's unit
/// nor the parameters' counts. For scattered samples the trace is estimated from fixed random
/// vectors [Hutchinson1990]. Throws SolverError when no lambda gives a solvable system.
Smoothing cross_validated(const NormalSystem& system, const Samples& samples,
                          const Parameters& parameters, int order);

/// What a stated lambda leaves. Throws SolverError when it gives no solvable system.
Smoothing smoothed_by(double lambda, const NormalSystem& system, const Samples& samples,
                      const Parameters& parameters, int order);

} // namespace batten
