#include <batten/core/counts.hpp>
#include <batten/core/names.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/output_place.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/points_file.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

/// A file format of points.
struct PointFormat {
    std::string_view extension;
    NumberArray (*parse)(const std::filesystem::path&, std::string_view);
    std::string (*format)(const Points&, const std::vector<Index>& grid);
    /// How its points follow each other where no grid is stated.
    Order order = Order::along_curve;
};

std::string comma_text(const Points& points, const std::vector<Index>&) {
    return format_text(points, ',');
}
std::string blank_text(const Points& points, const std::vector<Index>&) {
    return format_text(points, ' ');
}

constexpr PointFormat point_formats[] = {
    {".csv", parse_text, comma_text},       {".txt", parse_text, blank_text},
    {".xyz", parse_text, blank_text},       {".dat", parse_text, blank_text},
    {".npy", parse_npy, format_npy},        {".ply", parse_ply, {}, Order::none},
    {".obj", parse_obj, {}, Order::none},   {".stl", parse_stl, {}, Order::none},
    {".las", parse_las, {}, Order::ground},
};

const PointFormat& point_format(const std::filesystem::path& path) {
    const std::string wanted = extension_or(path, ".txt");
    std::vector<std::string_view> known;
    for (const PointFormat& format : point_formats) {
        if (format.extension == wanted) return format;
        known.push_back(format.extension);
    }
    throw InvalidInput(
        fmt::format("{}: {}", path.string(), unknown_name("extension of points", wanted, known)));
}

NumberArray read_numbers(const std::filesystem::path& path) {
    const PointFormat& format = point_format(path);
    const std::string content = read_file(path);
    if (content.empty()) throw FileError(fmt::format("{}: the file is empty", path.string()));
    return format.parse(path, content);
}

Samples heights_from(NumberArray array, const std::array<double, 2>& spacing,
                     const std::filesystem::path& path) {
    if (array.shape.size() != 2)
        throw InvalidInput(fmt::format("{}: heights need a table of 2 axes, got {}", path.string(),
                                       fmt::join(array.shape, "x")));
    const std::array<Index, 2> shape{array.shape[0], array.shape[1]};
    return height_samples(Points(PointSet(std::move(array.values), 1)), shape, spacing);
}

Samples points_from(NumberArray array, const std::vector<Index>& grid,
                    const std::filesystem::path& path) {
    const std::vector<Index>& shape = array.shape;
    if (shape.empty() || shape.size() > 4)
        throw InvalidInput(fmt::format(
            "{}: an array of {} axes; m x dim, or a grid m1 x m2 (x m3) x dim, is needed",
            path.string(), shape.size()));
    const Index dim = shape.size() == 1 ? 1 : shape.back();
    if (dim < 1 || dim > 16)
        throw InvalidInput(
            fmt::format("{}: {} means points of dimension {}, outside 1 to 16{}", path.string(),
                        fmt::join(shape, "x"), dim,
                        shape.size() == 2 ? "; heights reads it as a grid of heights" : ""));
    Samples samples;
    if (shape.size() > 2) samples.grid.assign(shape.begin(), shape.end() - 1);
    if (!grid.empty()) samples.grid = grid;
    samples.points = Points(PointSet(std::move(array.values), dim));
    samples.notes = std::move(array.notes);
    return samples;
}

} // namespace

Samples read_points(const std::filesystem::path& path, const ReadOptions& options) {
    if (options.heights && !options.grid.empty())
        throw InvalidInput(fmt::format("{}: a table of heights is a grid already; it is read with "
                                       "a grid's shape or as heights",
                                       path.string()));
    NumberArray array = read_numbers(path);
    Samples samples = options.heights ? heights_from(std::move(array), options.spacing, path)
                                      : points_from(std::move(array), options.grid, path);
    if (samples.grid.empty()) samples.order = point_format(path).order;
    check(samples);
    return samples;
}

PointSet read_table(const std::filesystem::path& path) {
    NumberArray array = read_numbers(path);
    PointSet table(std::move(array.values), array.shape.size() < 2 ? 1 : array.shape.back());
    for (Index i = 0; i < table.size(); ++i)
        for (double x : table[i])
            if (!std::isfinite(x))
                throw FileError(
                    fmt::format("{}: row {}: {} is not a finite number", path.string(), i, x));
    return table;
}

void check_room(const std::filesystem::path& path, std::span<const Index> counts, Index dim) {
    // a number takes 8 bytes, its text up to 25, of which half as much again while it grows
    const Index copies = point_format(path).format == format_npy ? 2 : 6;
    std::vector<Index> doubles(counts.begin(), counts.end());
    const std::string what = fmt::format("{} points", fmt::join(counts, "x"));
    checked_product(counts, what);
    doubles.insert(doubles.end(), {dim, copies});
    check_memory(checked_product(doubles, what), what);
}

std::string points_content(const std::filesystem::path& path, const Points& points,
                           const std::vector<Index>& grid) {
    const PointFormat& format = point_format(path);
    if (format.format == nullptr)
        throw InvalidInput(fmt::format("{}: {} files of points are read, not written",
                                       path.string(), format.extension));
    check({.points = points, .grid = grid});
    check_room(path, std::array{points.size()}, points.dim());
    return format.format(points, grid);
}

void write_points(const std::filesystem::path& path, const Points& points,
                  const std::vector<Index>& grid) {
    write_file(path, points_content(path, points, grid));
}

} // namespace batten
