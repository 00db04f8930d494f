#pragma once

#include <batten/samples/samples.hpp>

#include <array>
#include <filesystem>
#include <string>

namespace batten {

/// How a file of numbers becomes samples.
struct ReadOptions {
    /// Grid shape of a list of points; a .npy of 3 or 4 axes brings its own.
    std::vector<Index> grid{};
    /// The table is a grid of heights, sample (i, j) the point (i dx, j dy, h).
    bool heights = false;
    std::array<double, 2> spacing{1, 1};
};

/// Reads points by extension: .csv .txt .xyz .dat (text), .npy; `-` is text from standard input.
/// Throws FileError naming path, line and column, or InvalidInput for a grid that does not match.
Samples read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes points by extension: .csv .txt .xyz .dat (text), .npy (with the grid's shape); `-` is
/// text to standard output. Throws FileError; an existing file is replaced only by a complete one.
void write_points(const std::filesystem::path& path, const Points& points,
                  const std::vector<Index>& grid = {});

/// Reads a table of numbers (rows x columns) from a text or .npy file: parameters, weights, knots.
PointSet read_table(const std::filesystem::path& path);

} // namespace batten
