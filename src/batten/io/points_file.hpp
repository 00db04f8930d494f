#pragma once

#include <batten/samples/sample_source.hpp>

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace batten {

/// How far a file is read in this pass, in bytes as they stand in it.
struct ReadProgress {
    double bytes = 0;
    double of = 0; ///< 0: only the end will tell
};
/// Called by the reading thread, after some megabytes each time.
using ReadObserver = std::function<void(const ReadProgress&)>;

/// How a file of numbers becomes samples.
struct ReadOptions {
    /// Grid shape of a list of points; a .npy of 3 or 4 axes brings its own.
    std::vector<Index> grid{};
    /// The table is a grid of heights, sample (i, j) the point (i dx, j dy, h).
    bool heights = false;
    std::array<double, 2> spacing{1, 1};
    ReadObserver observer{};
};

/// Reads points by extension: .csv .txt .xyz .dat (text, or text compressed: .csv.gz), .npy .ply
/// .obj .stl .las; `-` is text from standard input, as is any stream without extension.
/// Throws FileError naming path, line and column, or what changed in the file meanwhile;
/// InvalidInput for a grid that does not match or is given beside heights.
Samples read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same samples in chunks that are read from the file whenever they are asked for: in memory
/// are a few megabytes, and what one next() gave. Held as a whole are the vertices of .obj, .stl
/// and ascii .ply, a .npy of Fortran order and an airfoil's two blocks; a pipe's bytes are kept in
/// an unnamed temporary file.
/// Throws as read_points does, here or in a pass; there InvalidInput, with path and line or index,
/// for a coordinate that is not finite.
std::unique_ptr<SampleSource> open_points(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// What a file of points holds, by extension: .csv .txt .xyz .dat (text), .npy (with the grid's
/// shape); of `-`, or a stream without extension, text. Throws InvalidInput for another extension,
/// a coordinate that is not finite, a grid that does not match, or more than memory holds.
std::string points_content(const std::filesystem::path& path, const Points& points,
                           const std::vector<Index>& grid = {});

/// Throws InvalidInput when memory cannot hold `counts` points per axis of dimension `dim` and what
/// the file will hold of them: to be asked before they are made.
void check_room(const std::filesystem::path& path, std::span<const Index> counts, Index dim);

/// Writes points_content. Throws FileError; an existing file is replaced only by a complete one.
void write_points(const std::filesystem::path& path, const Points& points,
                  const std::vector<Index>& grid = {});

/// Reads a table of finite numbers (rows x columns) from a text or .npy file: parameters, weights,
/// knots. Throws FileError.
PointSet read_table(const std::filesystem::path& path);

} // namespace batten
