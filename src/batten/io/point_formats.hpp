#pragma once

#include <batten/io/byte_source.hpp>
#include <batten/io/number_reader.hpp>
#include <batten/samples/samples.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// A file format of points.
struct PointFormat {
    using Open = std::unique_ptr<NumberReader> (*)(const std::filesystem::path&,
                                                   std::unique_ptr<ByteSource>);
    std::string_view extension;
    Open open;            ///< to be read once, as a whole
    Open open_for_passes; ///< to be read in parts, again and again
    std::string (*format)(const Points&, const std::vector<Index>& grid);
    /// How its points follow each other where no grid is stated.
    Order order = Order::along_curve;
};

/// The file's format, by its extension; of a stream without one text. Throws InvalidInput.
const PointFormat& point_format(const std::filesystem::path& path);

// What an array's shape means; they throw InvalidInput where it means no points.
void check_options(const std::filesystem::path& path, const ReadOptions& options);
std::array<Index, 2> height_shape(const std::filesystem::path& path,
                                  const std::vector<Index>& shape);
Index point_dim(const std::filesystem::path& path, const std::vector<Index>& shape);
std::vector<Index> point_grid(const std::vector<Index>& shape, const ReadOptions& options);

// Each format's numbers, to be read from the first to the last; `path` is for messages only. The
// functions throw FileError for what their format does not allow or end too early.

/// Text table; an airfoil file (.dat) may hold a title, notes, a count line and two blocks, which
/// are joined into one run around the section.
std::unique_ptr<NumberReader> open_text(const std::filesystem::path& path,
                                        std::unique_ptr<ByteSource> bytes);
/// The same with what takes all rows to know found out: the first column left out where it counts
/// them without having a name, two blocks joined (and held in memory).
std::unique_ptr<NumberReader> open_text_for_passes(const std::filesystem::path& path,
                                                   std::unique_ptr<ByteSource> bytes);
std::string format_text(const Points& points, char separator);

/// NumPy's .npy, versions 1 to 3, real floats and integers of either byte order, C or Fortran
/// order.
std::unique_ptr<NumberReader> open_npy(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> bytes);
std::string format_npy(const Points& points, const std::vector<Index>& grid);

/// Vertices of a PLY file: ascii or binary of either byte order, other properties and elements left
/// out.
std::unique_ptr<NumberReader> open_ply(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> bytes);

/// Vertices (`v`) of a Wavefront OBJ file.
std::unique_ptr<NumberReader> open_obj(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> bytes);

/// Vertices of an STL file, ascii or binary, each once.
std::unique_ptr<NumberReader> open_stl(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> bytes);

/// Points of an uncompressed LAS file, versions 1.2 to 1.4, any point format.
std::unique_ptr<NumberReader> open_las(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> bytes);

} // namespace batten
