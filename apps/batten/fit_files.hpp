#pragma once

#include "fit_flags.hpp"
#include <batten/io/output_place.hpp>

namespace batten::command {

/// Asked before anything is read: throws InvalidInput or FileError for outputs of `batten fit` that
/// cannot be written, or that are also read or written twice.
void check_files(const FitFlags& flags);

/// Asked before the fit: throws InvalidInput for outputs that cannot hold the spline of the
/// samples.
void check_holds(const FitFlags& flags, const Samples& samples, const FitOptions& options);

/// Whether an output goes to standard output, under whatever name.
bool writes_standard_output(const FitFlags& flags);

/// Whether one of the outputs is the standard output, so that words must go elsewhere.
bool take_standard_output(std::span<const FileUse> outputs);

} // namespace batten::command
