#pragma once

#include <batten/solve/extreme_eigenvalues.hpp>

#include <vector>

namespace batten {

/// How much work a rate is worth.
struct RateEffort {
    Index directions = 60;
    int restarts = 6;
};

/// How fast the moves d of an iteration d <- d - weight B d fade: the largest |1 - weight theta|
/// over the eigenvalues theta of B, the factor by which moves shrink, or grow, in the long run.
///
/// B need be neither symmetric nor normal. By Arnoldi's method restarted from the slowest direction
/// [Saad2011, section 6.2], in the smallest space that holds `start` (of B's size, not zero) and
/// its images. Exact to rounding up to as many unknowns as directions; where the matrix is far from
/// normal, rounding itself moves its eigenvalues.
double convergence_rate(const VectorOperator& b, double weight, std::vector<double> start,
                        RateEffort effort = {});

} // namespace batten
