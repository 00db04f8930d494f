#pragma once

#include <batten/io/spline_file.hpp>

namespace batten::cad {

/// STEP (AP214) text of curves as edges and surfaces as faces, exact knots and poles, the scene's
/// title as product name, its unit, its date (a fixed one when empty); closed axes are clamped.
/// Throws InvalidInput for volumes and dimensions other than 2 and 3.
std::string step_text(const Scene& scene);

/// The same as IGES 5.3.
std::string iges_text(const Scene& scene);

/// B-spline curves and surfaces of a STEP or IGES file, in the file's own unit. Throws FileError
/// when it holds none or cannot be read, InvalidInput for rational ones.
std::vector<Spline> parse_step(const std::filesystem::path& path, const std::string& content);
std::vector<Spline> parse_iges(const std::filesystem::path& path, const std::string& content);

/// What the loaded module offers: the functions above behind one symbol, `batten_cad_module`.
struct Module {
    std::string (*step_text)(const Scene&);
    std::string (*iges_text)(const Scene&);
    std::vector<Spline> (*parse_step)(const std::filesystem::path&, const std::string&);
    std::vector<Spline> (*parse_iges)(const std::filesystem::path&, const std::string&);
};

} // namespace batten::cad

extern "C" __attribute__((visibility("default"))) const batten::cad::Module* batten_cad_module();
