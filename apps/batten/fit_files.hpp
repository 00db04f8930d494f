#pragma once

#include "fit_flags.hpp"

namespace batten::command {

/// Asked before anything is read: throws InvalidInput or FileError for outputs of `batten fit` that
/// cannot be written, or that are also read or written twice.
void check_files(const FitFlags& flags);

/// Whether an output goes to standard output, under whatever name.
bool writes_standard_output(const FitFlags& flags);

} // namespace batten::command
