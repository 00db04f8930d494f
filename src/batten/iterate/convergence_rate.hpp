#pragma once

#include <batten/solve/extreme_eigenvalues.hpp>

#include <complex>
#include <vector>

namespace batten {

/// How much work a rate is worth.
struct RateEffort {
    Index directions = 80;
    int restarts = 8;
};

/// The factor by which moves shrink, or grow, in the long run.
struct ConvergenceRate {
    double value = 0;
    /// How far off it may be: the residual of its direction times the eigenvalue's condition, or by
    /// how much another of the slowest directions that were seen may be slower.
    double accuracy = 0;
    std::complex<double> eigenvalue{}; ///< theta, of which it is |1 - weight theta|
};

/// How fast the moves d of an iteration d <- d - weight B d fade: the largest |1 - weight theta|
/// over the eigenvalues theta of B.
///
/// B need be neither symmetric nor normal. By Arnoldi's method restarted from the slowest direction
/// [Saad2011, section 6.2], in the smallest space that holds `start` (of B's size, not zero) and
/// its images. Exact to rounding up to as many unknowns as directions; where the matrix is far from
/// normal, rounding itself moves its eigenvalues.
ConvergenceRate convergence_rate(const VectorOperator& b, double weight, std::vector<double> start,
                                 RateEffort effort = {});

/// The weight for which that rate is least: 2 / (1 + the smallest eigenvalue) where they are real
/// and at most 1 [Lu2010]. By exchange: the eigenvalue that is slowest for a weight joins those
/// that the next one is best for, `known` ones from the start. 1 where no weight lets all moves
/// fade.
double best_weight(const VectorOperator& b, const std::vector<double>& start,
                   RateEffort effort = {}, std::vector<std::complex<double>> known = {});

} // namespace batten
