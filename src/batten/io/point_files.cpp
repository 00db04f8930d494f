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

std::string comma_text(const Points& points, const std::vector<Index>&) {
    return format_text(points, ',');
}
std::string blank_text(const Points& points, const std::vector<Index>&) {
    return format_text(points, ' ');
}

constexpr PointFormat point_formats[] = {
    {".csv", open_text, open_text_for_passes, comma_text},
    {".txt", open_text, open_text_for_passes, blank_text},
    {".xyz", open_text, open_text_for_passes, blank_text},
    {".dat", open_text, open_text_for_passes, blank_text},
    {".npy", open_npy, open_npy, format_npy},
    {".ply", open_ply, open_ply, {}, Order::none},
    {".obj", open_obj, open_obj, {}, Order::none},
    {".stl", open_stl, open_stl, {}, Order::none},
    {".las", open_las, open_las, {}, Order::ground},
};

} // namespace

const PointFormat& point_format(const std::filesystem::path& path) {
    const bool compressed = extension(path) == ".gz";
    const std::string wanted = compressed ? inner_extension(path) : extension_or(path, ".txt");
    std::vector<std::string_view> known;
    for (const PointFormat& format : point_formats) {
        const bool text = format.open == open_text;
        if (format.extension == wanted && (text || !compressed)) return format;
        if (text || !compressed) known.push_back(format.extension);
    }
    throw InvalidInput(fmt::format(
        "{}: {}", path.string(),
        unknown_name(compressed ? "extension of compressed points" : "extension of points", wanted,
                     known)));
}

std::array<Index, 2> height_shape(const std::filesystem::path& path,
                                  const std::vector<Index>& shape) {
    if (shape.size() != 2)
        throw InvalidInput(fmt::format("{}: heights need a table of 2 axes, got {}", path.string(),
                                       fmt::join(shape, "x")));
    return {shape[0], shape[1]};
}

Index point_dim(const std::filesystem::path& path, const std::vector<Index>& shape) {
    if (shape.empty() || shape.size() > 4)
        throw InvalidInput(fmt::format(
            "{}: an array of {} axes; m x dim, or a grid m1 x m2 (x m3) x dim, is needed",
            path.string(), shape.size()));
    const Index dim = shape.size() == 1 ? 1 : shape.back();
    if (dim < 1 || dim > 16) {
        const std::string rows = shape[0] < 0 ? "m" : fmt::to_string(shape[0]);
        throw InvalidInput(
            fmt::format("{}: {}x{} means points of dimension {}, outside 1 to 16{}", path.string(),
                        rows, fmt::join(shape.begin() + 1, shape.end(), "x"), dim,
                        shape.size() == 2 ? "; heights reads it as a grid of heights" : ""));
    }
    return dim;
}

std::vector<Index> point_grid(const std::vector<Index>& shape, const ReadOptions& options) {
    if (!options.grid.empty()) return options.grid;
    return shape.size() > 2 ? std::vector<Index>(shape.begin(), shape.end() - 1)
                            : std::vector<Index>{};
}

void check_options(const std::filesystem::path& path, const ReadOptions& options) {
    if (options.heights && !options.grid.empty())
        throw InvalidInput(fmt::format("{}: a table of heights is a grid already; it is read with "
                                       "a grid's shape or as heights",
                                       path.string()));
}

namespace {

NumberArray read_numbers(const std::filesystem::path& path, const ReadObserver& observer = {}) {
    const PointFormat& format = point_format(path);
    return format.open(path, open_bytes(path, ReadAgain::no, observer))->all();
}

Samples points_from(NumberArray array, const ReadOptions& options,
                    const std::filesystem::path& path) {
    const Index dim = point_dim(path, array.shape);
    const auto count = static_cast<Index>(array.values.size()) / dim;
    Samples samples;
    samples.grid = point_grid(array.shape, options);
    samples.points = std::move(array.values).points(count, dim);
    samples.notes = std::move(array.notes);
    return samples;
}

Samples heights_from(NumberArray array, const ReadOptions& options,
                     const std::filesystem::path& path) {
    const std::array<Index, 2> shape = height_shape(path, array.shape);
    const auto count = static_cast<Index>(array.values.size());
    return height_samples(std::move(array.values).points(count, 1), shape, options.spacing);
}

} // namespace

Samples read_points(const std::filesystem::path& path, const ReadOptions& options) {
    check_options(path, options);
    NumberArray array = read_numbers(path, options.observer);
    Samples samples = options.heights ? heights_from(std::move(array), options, path)
                                      : points_from(std::move(array), options, path);
    if (samples.grid.empty()) samples.order = point_format(path).order;
    check(samples);
    return samples;
}

PointSet read_table(const std::filesystem::path& path) {
    NumberArray array = read_numbers(path);
    const std::span<const double> values = array.values.values();
    PointSet table(std::vector<double>(values.begin(), values.end()),
                   array.shape.size() < 2 ? 1 : array.shape.back());
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
    const std::string named = extension_or(path, ".txt");
    if (format.format == nullptr || named == ".gz")
        throw InvalidInput(
            fmt::format("{}: {} files of points are read, not written", path.string(), named));
    check({.points = points, .grid = grid});
    check_room(path, std::array{points.size()}, points.dim());
    return format.format(points, grid);
}

void write_points(const std::filesystem::path& path, const Points& points,
                  const std::vector<Index>& grid) {
    write_file(path, points_content(path, points, grid));
}

} // namespace batten
