#pragma once

#include <batten/io/spline_file.hpp>

namespace batten {

/// Wavefront OBJ free-form curve or surface (`cstype bspline`) in space; several follow each other.
std::string obj_text(const Scene& scene);

/// GoTools .g2 curves (100), surfaces (200) and volumes (700); several follow each other.
std::string g2_text(const Scene& scene);

/// Triangles of surfaces, and of volumes' faces, within the scene's chord tolerance, binary.
std::string stl_binary(const Scene& scene);

/// A row of parameters and point per place, dense enough for the chord tolerance.
std::string evaluated_text(const Scene& scene);

/// VTK XML structured grid: the spline sampled.
std::string vts_text(const Scene& scene);

/// VTK XML unstructured grid: samples (with their deviation as point data), control net and the
/// spline sampled; point data `part` is 0, 1, 2 for these.
std::string vtu_text(const Scene& scene);

} // namespace batten
