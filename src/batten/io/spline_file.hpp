#pragma once

#include <batten/samples/samples.hpp>
#include <batten/spline/spline.hpp>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// What a spline format may show: the spline itself, and the samples it was fitted to where a
/// picture wants them.
struct Scene {
    const Spline& spline;
    const Samples* samples = nullptr;
    std::string title{};
    /// Draw the curvature comb: normals as long as the curvature, where a picture can.
    bool curvature_comb = false;
};

/// A file format of splines, found by its extension (with the dot, lower case).
struct SplineFormat {
    std::string extension;
    std::string description;
    /// The file's whole content; throws InvalidInput for a spline that the format cannot hold.
    std::function<std::string(const Scene&)> write;
    /// Parses a file's content (path only for messages); empty when the format is written only.
    std::function<Spline(const std::filesystem::path&, const std::string&)> read;
};

/// The formats known now, in order of registration.
std::span<const SplineFormat> spline_formats();

/// Adds a format, before any thread uses the registry.
void register_format(SplineFormat format);

/// Throws InvalidInput when no spline format has the extension, FileError when the folder does not
/// exist: to be asked before the work, so that a fit is not lost to a slip of the pen.
void check_output(const std::filesystem::path& path);

/// Throws FileError when the folder of `path` does not exist.
void check_folder(const std::filesystem::path& path);

/// Reads a spline by extension; throws FileError with path and place.
Spline read_spline(const std::filesystem::path& path);

/// Writes by extension; `-` is JSON to standard output. An existing file is replaced only by a
/// complete one.
void write_spline(const std::filesystem::path& path, const Scene& scene);

/// The JSON of docs/formats.md, numbers exact.
std::string spline_json(const Spline& spline);

/// Parses that JSON; throws FileError with path and what is wrong.
Spline parse_spline_json(const std::filesystem::path& path, const std::string& content);

} // namespace batten
