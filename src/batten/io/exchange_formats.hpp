#pragma once

#include <batten/io/spline_file.hpp>

namespace batten {

/// Wavefront OBJ free-form curve or surface (`cstype bspline`) in space, of a function its graph;
/// several follow each other.
std::string obj_text(const Scene& scene);

/// GoTools .g2 curves (100), surfaces (200) and volumes (700); several follow each other.
std::string g2_text(const Scene& scene);

/// Triangles of surfaces, and of volumes' faces, within the scene's chord tolerance, binary: seams
/// and poles share their points, what encloses something is seen from outside.
std::string stl_binary(const Scene& scene);

/// Where single precision takes more than half the chord tolerance, a sentence that says so.
std::string stl_note(const Scene& scene);

/// A row of parameters and point per place, dense enough for the chord tolerance.
std::string evaluated_text(const Scene& scene);

/// VTK XML structured grid: the spline sampled. Of a function its graph (of three variables their
/// box), with the point data `value`.
std::string vts_text(const Scene& scene);

/// VTK XML unstructured grid: samples (with their deviation as point data), control net and the
/// spline sampled; point data `part` is 0, 1, 2 for these. Of a function as in vts_text.
std::string vtu_text(const Scene& scene);

} // namespace batten
