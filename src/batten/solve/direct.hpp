#pragma once

#include <batten/solve/sample_rows.hpp>
#include <batten/system/constraints.hpp>
#include <batten/system/normal_system.hpp>

#include <optional>

namespace batten {

/// Least-squares control points (N x dim) relative to the system's centre.
/// Throws SolverError when the samples do not determine every control point.
PointSet solve_direct(const NormalSystem& system);

/// The same under constraints C P = d (relative to the centre), from the saddle-point system
/// [ChangMaDeng2023, eq. 1]: a solve per constraint and a small dense system for the multipliers.
/// Directions get the lengths that leave the least error. Throws as above, and InvalidInput as
/// Constraints::independent does.
PointSet solve_direct(const NormalSystem& system, const Constraints& constraints);

/// The same from the rows that a system with factors was made of where its normal equations cannot
/// be solved to half of a number's digits, with smoothing or weights to ten.
PointSet solve_direct(const NormalSystem& system, const SampleRows& rows,
                      const Constraints& constraints);

/// The same of samples of weight one or others, without constraints and smoothing; nothing where
/// it would take the rows.
std::optional<PointSet> solve_direct_without_rows(const NormalSystem& system, bool weighted);

/// By how much constraints reduce the trace of the matrix that makes fitted values of the samples,
/// for their system without roughness and with it: by trace (C S^{-1} C^T)^{-1} C S^{-1} G S^{-1}
/// C^T. Free lengths count as held.
double freedom_held(const NormalSystem& samples, const NormalSystem& smoothed,
                    const SampleRows& rows, const Constraints& constraints);

/// Independent constraints with their directions' lengths as the fit above chooses them.
Constraints with_best_lengths(const NormalSystem& system, const Constraints& constraints);

} // namespace batten
