#pragma once

#include <filesystem>
#include <functional>

#ifndef BATTEN_CAD_PROGRAM // where batten-cad was installed: the CMake target batten::cad says it
#define BATTEN_CAD_PROGRAM ""
#endif

namespace batten::cad {

struct Options {
    /// The program `batten-cad`, in which Open CASCADE runs; where this one is missing, the one
    /// beside the calling program or in ../libexec from there is taken.
    std::filesystem::path program = BATTEN_CAD_PROGRAM;
    /// Asked about ten times a second while a file is read or written, in the thread that does so;
    /// true ends the work at once, and batten::Cancelled is thrown.
    std::function<bool()> cancelled{};
};

/// From now on read_spline, write_spline and all that goes by a file's extension know .step .stp
/// .igs .iges, before any thread uses them; called again, it replaces the options.
///
/// Open CASCADE runs in a process of its own, started for each file, so that it is no part of the
/// calling program and a damaged file cannot end that: it throws FileError, `path: Open CASCADE
/// failed while reading it (why)`, also for what takes more than 5 s of processor time and 10 s for
/// each megabyte, or 1 GiB of memory and 64 times the file. Rational splines throw InvalidInput, as
/// does a missing `batten-cad`.
void register_formats(Options options = {});

} // namespace batten::cad
