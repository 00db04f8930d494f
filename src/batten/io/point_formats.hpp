#pragma once

#include <batten/samples/samples.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// Numbers of a file with the shape they came in: {rows, columns} of a text, any shape of a .npy.
struct NumberArray {
    std::vector<double> values;
    std::vector<Index> shape;
    std::vector<std::string> notes;
};

/// Text table; an airfoil file (.dat) may hold a title, notes, a count line and two blocks, which
/// are joined into one run around the section.
NumberArray parse_text(const std::filesystem::path& path, std::string_view text);
std::string format_text(const Points& points, char separator);

/// NumPy's .npy, versions 1 to 3, real floats and integers of either byte order, C or Fortran
/// order.
NumberArray parse_npy(const std::filesystem::path& path, std::string_view content);
std::string format_npy(const Points& points, const std::vector<Index>& grid);

/// Vertices of a PLY file: ascii or binary of either byte order, other properties and elements left
/// out.
NumberArray parse_ply(const std::filesystem::path& path, std::string_view content);

/// Vertices (`v`) of a Wavefront OBJ file.
NumberArray parse_obj(const std::filesystem::path& path, std::string_view content);

/// Vertices of an STL file, ascii or binary, each once.
NumberArray parse_stl(const std::filesystem::path& path, std::string_view content);

/// Points of an uncompressed LAS file, versions 1.2 to 1.4, any point format.
NumberArray parse_las(const std::filesystem::path& path, std::string_view content);

} // namespace batten
