#pragma once

#include <batten/problem/options.hpp>
#include <batten/problem/result.hpp>
#include <batten/samples/sample_source.hpp>

#include <optional>

namespace batten {

/// A fit in passes over the samples: the account says how it went, nothing is measured twice.
struct Passed {
    Fitted fitted; ///< parameters and deviations where they are to be kept
    Index samples = 0;
    Index equal = 0; ///< of them share the parameter of the one before
    double size = 0; ///< diagonal of their box
    Deviation deviation{};
};

/// Least squares of a sequence for a stated size or knots, directly, in three passes: what the
/// samples are and where the rule puts knots [PieglTiller1997, eq. 9.69], the normal equations, the
/// deviations. What is made of the samples is made of a chunk at a time, so that no more memory is
/// needed for many than for few.
///
/// Nothing where the samples are needed in memory: what is asked is not in the column of the table
/// (chosen_in_passes), or it turns out that they leave control points undetermined, that the normal
/// equations lose too many digits, or that numbers are to be scaled. Throws InvalidInput as
/// problem_of does, and Cancelled.
std::optional<Passed> fit_in_passes(SampleSource& source, const FitOptions& options);

} // namespace batten
