#pragma once

#include <batten/core/points.hpp>
#include <batten/system/banded_matrix.hpp>

#include <memory>
#include <vector>

namespace batten {

class NormalSystem;
struct Samples;

/// All that a normal system knows of its samples, as plain sums over them: to be saved
/// (io/system_file.hpp), added up and solved without the samples.
struct SystemSums {
    std::vector<KnotVector> axes{};
    std::vector<double> centre{}; ///< (dim), what coordinates are relative to
    Index samples = 0;
    double weight = 0; ///< sum of the samples' weights
    double energy = 0; ///< sum of weight |Q - centre|^2
    PointSet box{};    ///< corners of the samples' box, (2 x dim)
    PointSet rhs{};    ///< A^T D (Q - centre), (N x dim)
    /// Per axis the banded matrix whose Kronecker product A^T D A is; else it is in `stencil`.
    std::vector<BandedMatrix> factors{};
    /// Half a stencil per control point (half_stencil.hpp): (places x N).
    std::vector<double> stencil{};
    /// Beside it, per axis the matrix of the samples' B-splines along that axis alone.
    std::vector<BandedMatrix> axis_sums{};
    /// Beside it, of a grid, per axis the mean over its parameters of products of B-splines.
    std::vector<BandedMatrix> grid_means{};
};

/// The sums that a system of these samples consists of, with the samples' box and weight.
SystemSums sums_of(const NormalSystem& system, const Samples& samples);

/// The normal system that the sums belong to.
std::unique_ptr<NormalSystem> system_of(SystemSums sums);

/// The same about another centre (dim): Q - c' = (Q - c) + (c - c'), and B-splines sum to one.
SystemSums recentred(SystemSums sums, const std::vector<double>& centre);

/// The sums over the samples of both, about the first one's centre. Grids whose parameters differ
/// along one axis at most make a grid; all else is a cloud with parameters. Throws InvalidInput
/// naming what differs: the number of axes, coordinates, degrees, closed axes or knots.
SystemSums merged(SystemSums first, const SystemSums& second);

/// The sums of the same samples over knots nested in theirs, one vector per axis: T^T (A^T D A) T
/// and T^T A^T D Q for the matrix T that inserts the knots that are missing. Throws InvalidInput
/// naming the axis whose knots are not nested.
SystemSums coarsened(SystemSums sums, const std::vector<KnotVector>& axes);

/// The sum of weight |Q - A P|^2, without the samples, for control points (N x dim) relative to the
/// centre, and how far rounded sums may be off it.
struct ResidualEnergy {
    double value;    ///< not negative
    double rounding; ///< of the value
};
ResidualEnergy residual_energy(const NormalSystem& system, const PointSet& control);

} // namespace batten
