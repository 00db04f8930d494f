#pragma once

#include "fit_flags.hpp"

namespace batten::command {

/// Asked before anything is read: throws InvalidInput or FileError for outputs of `batten fit` that
/// cannot be written, or that are also read or written twice.
void check_files(const FitFlags& flags);

/// Asked before the fit: throws InvalidInput for outputs that cannot hold the spline of the
/// samples.
void check_holds(const FitFlags& flags, const Samples& samples, const FitOptions& options);

/// Whether an output goes to standard output, under whatever name.
bool writes_standard_output(const FitFlags& flags);

} // namespace batten::command
