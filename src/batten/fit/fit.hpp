#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>
#include <batten/samples/sample_source.hpp>

namespace batten {

/// Fits a B-spline curve, surface or volume to a sequence, grid or cloud: with as few control
/// points as hold a tolerance (a thousandth of the samples' diagonal where nothing is stated), or
/// of a stated size or knots by least squares, or by the method that the options name.
///
/// A stated goal that is not reached is no error: FitReport::goals_met() tells. Throws InvalidInput
/// for samples and options that break a rule or do not go together (problem_of, check_column) or,
/// with the direct solver, leave control points undetermined; Cancelled when asked to stop.
FitResult fit(const Samples& samples, const FitOptions& options = {});

/// The same of samples that are read in chunks. A sequence for a stated size or knots is fitted
/// directly in three passes, or four where the source does not know how many samples it has, with
/// memory for some chunks and the control points; for all else, and weights of which the largest
/// is not from 1 to 2, the samples are read into memory, or InvalidInput says how much would be
/// needed. Results are those of the samples in memory,
/// whatever the chunks.
FitResult fit(SampleSource& samples, const FitOptions& options = {});

} // namespace batten
