#pragma once

#include <batten/io/format_limits.hpp>
#include <batten/parametrize/parametrize.hpp>
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
    /// Distance of each sample from the spline; null where not known.
    const std::vector<double>* deviations = nullptr;
    /// The samples' parameters: where the samples of a function are drawn.
    const Parameters* parameters = nullptr;
    /// Further splines, for formats that hold several.
    std::vector<const Spline*> more{};
    /// How far sampled formats may be from the spline; 0: a thousandth of its size.
    double chord_tolerance = 0;
    /// Unit of the coordinates for CAD files: mm, cm, m or in.
    std::string unit = "mm";
    /// Date in the header of CAD files, 2026-01-31T12:00:00; empty: a fixed one, so that equal
    /// splines give equal bytes.
    std::string date{};

    /// All splines, the first one first.
    std::vector<const Spline*> splines() const {
        std::vector<const Spline*> all{&spline};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

/// What was read from a file of splines.
struct SplineFile {
    std::vector<Spline> splines;
    std::vector<std::string> notes{}; ///< what of the file is not in them, a line each
};

/// What of a scene, beside splines and samples, a format shows.
enum class SceneDetail { none, unit_and_date, chord_tolerance };

/// A file format of splines, found by its extension (with the dot, lower case).
struct SplineFormat {
    std::string extension;
    std::string description;
    /// The file's whole content; throws InvalidInput for a spline that the format cannot hold.
    std::function<std::string(const Scene&)> write;
    /// Parses a file's content (path only for messages); empty when the format is written only.
    std::function<SplineFile(const std::filesystem::path&, const std::string&)> read;
    /// Whether a file may hold several splines.
    bool several = false;
    FormatLimits limits{};
    SceneDetail shows = SceneDetail::none;
    /// One sentence on what the file loses of the scene, empty where nothing is to be said.
    std::function<std::string(const Scene&)> note{};
    /// Whether the scene's samples are shown with their deviations.
    bool samples = false;
};

/// The formats known now, in order of registration.
std::span<const SplineFormat> spline_formats();

/// The format that the file's extension names, of a stream without extension JSON; throws
/// InvalidInput for an unknown one.
const SplineFormat& spline_format(const std::filesystem::path& path);

/// Adds a format, before any thread uses the registry.
void register_format(SplineFormat format);

/// Throws InvalidInput when no spline format has the extension, FileError when the file cannot be
/// written there: to be asked before the work, so that a fit is not lost to a slip of the pen.
void check_output(const std::filesystem::path& path);

/// Throws InvalidInput when the file's format holds no spline of so many axes and dimension: also
/// to be asked before the work.
void check_holds(const std::filesystem::path& path, Index axes, Index dim);

/// Reads all splines of a file, by extension; throws FileError with path and place.
SplineFile read_splines(const std::filesystem::path& path);

/// The spline of a file with this number, counted from 1, or (0) the only one; throws InvalidInput
/// with the file's path where there is none, or several for 0.
Spline one_of(SplineFile file, const std::filesystem::path& path, Index entity);

/// Reads one spline: one_of(read_splines).
Spline read_spline(const std::filesystem::path& path, Index entity = 0);

/// Whether some format of splines that can be read has the file's extension.
bool is_spline_file(const std::filesystem::path& path);

/// What a file of the scene holds, by extension; of `-`, or a stream without extension, JSON.
/// Throws InvalidInput for what the format cannot hold: several splines, dimensions, numbers that
/// are not finite, an unknown unit.
std::string spline_content(const std::filesystem::path& path, const Scene& scene);

/// One sentence on what that file loses of the scene; empty where nothing is to be said.
std::string spline_note(const std::filesystem::path& path, const Scene& scene);

/// Writes spline_content. Throws FileError; an existing file is replaced only by a complete one.
void write_spline(const std::filesystem::path& path, const Scene& scene);

/// The JSON of docs/formats.md, numbers exact.
std::string spline_json(const Spline& spline);

/// Parses that JSON; throws FileError with path and what is wrong.
Spline parse_spline_json(const std::filesystem::path& path, const std::string& content);

} // namespace batten
