#pragma once

#include <batten/io/spline_file.hpp>

namespace batten::cad {

/// STEP (AP214) text of curves as edges and surfaces as faces, exact knots and poles, the scene's
/// title as product name, its unit, its date (a fixed one when empty); closed axes are clamped.
/// Throws InvalidInput for volumes and dimensions other than 2 and 3.
std::string step_text(const Scene& scene);

/// The same as IGES 5.3.
std::string iges_text(const Scene& scene);

/// B-spline curves and surfaces of a STEP or IGES file, in the file's own unit, trimmed ones their
/// part; what is left out is noted. Throws FileError when it holds none, is cut off or cannot be
/// read, InvalidInput for rational ones, SolverError when Open CASCADE gives up.
SplineFile parse_step(const std::filesystem::path& path, const std::string& content);
SplineFile parse_iges(const std::filesystem::path& path, const std::string& content);

} // namespace batten::cad
