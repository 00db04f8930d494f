#pragma once

#include <batten/problem/options.hpp>
#include <batten/system/system_sums.hpp>

#include <string>

namespace batten {

/// How saved sums are solved.
struct SolveOptions {
    /// Free control points per axis, or one number for all: those of nested_knots of the system's;
    /// empty: the system's own.
    std::vector<Index> control_points{};
    /// Or any knots nested in the system's, per axis.
    std::vector<std::vector<double>> knots{};
    /// As of a fit, with a stated factor.
    SmoothOptions smooth{};
};

/// How close the spline comes, as far as that is known without the samples.
struct SolveReport {
    std::string kind{}; ///< curve, surface or volume
    Index samples = 0;
    Index dim = 0;
    std::vector<int> degree{};
    std::vector<Index> control_shape{};   ///< free control points per axis
    std::vector<Index> assembled_shape{}; ///< of the system as it was saved
    std::vector<Closure> closures{};
    bool weighted = false;   ///< the samples have weights, so has the mean of the squares
    double rms = 0;          ///< root of the mean squared residual, from the saved sums
    double rms_rounding = 0; ///< a smaller root cannot be told from rounded sums
    double data_size = 0;    ///< diagonal of the samples' box
    double smoothing = 0;    ///< factor of the roughness; 0: none
    double digits = 0;       ///< that the normal equations leave to the control points
    double seconds = 0;

    /// Whether the root is more than the rounding of the saved sums.
    bool rms_known() const { return rms > rms_rounding; }
    /// The account in lines of words.
    std::string full() const;
    /// The JSON of docs/formats.md.
    std::string to_json() const;
};

struct SolveResult {
    Spline spline;
    SolveReport report;
};

/// The least-squares spline of the samples that the sums are over, without them. Throws
/// InvalidInput for a size that is not nested (with those that are), knots that are not, or a
/// smoothing that is auto, has an order above a degree or a factor beyond rounded numbers;
/// SolverError where the samples do not determine every control point.
SolveResult solve_system(SystemSums sums, const SolveOptions& options = {});

} // namespace batten
