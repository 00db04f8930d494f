#include <batten/core/names.hpp>
#include <batten/io/exchange_formats.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/output_place.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/svg.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

std::vector<SplineFormat>& registry() {
    static std::vector<SplineFormat> all = {
        {".json", "batten's own exact format",
         [](const Scene& scene) { return spline_json(scene.spline); },
         [](const std::filesystem::path& path, const std::string& content) {
             return SplineFile{{parse_spline_json(path, content)}};
         }},
        {".svg",
         "picture of a planar curve, exact cubic Beziers",
         svg_picture,
         {},
         false,
         svg_limits,
         SceneDetail::none,
         {},
         true},
        {".obj", "Wavefront free-form curves and surfaces", obj_text, {}, true, obj_limits},
        {".g2", "GoTools curves, surfaces and volumes", g2_text, {}, true},
        {".stl",
         "triangles of surfaces, within the chord tolerance",
         stl_binary,
         {},
         true,
         stl_limits,
         SceneDetail::chord_tolerance,
         stl_note},
        {".vts",
         "VTK structured grid: the spline sampled",
         vts_text,
         {},
         false,
         vts_limits,
         SceneDetail::chord_tolerance},
        {".vtu",
         "VTK unstructured grid: samples with deviation, control net, spline",
         vtu_text,
         {},
         false,
         vtu_limits,
         SceneDetail::chord_tolerance,
         {},
         true},
        {".csv",
         "evaluated points, within the chord tolerance",
         evaluated_text,
         {},
         false,
         {},
         SceneDetail::chord_tolerance},
    };
    return all;
}

/// Formats that are known once a library of their own has been linked and asked to.
constexpr std::string_view cad_extensions[] = {".step", ".stp", ".igs", ".iges"};

} // namespace

std::span<const SplineFormat> spline_formats() {
    return registry();
}

const SplineFormat& spline_format(const std::filesystem::path& path) {
    const std::string wanted = extension_or(path, ".json");
    std::vector<std::string_view> known;
    for (const SplineFormat& format : registry()) {
        if (format.extension == wanted) return format;
        known.push_back(format.extension);
    }
    if (std::ranges::find(cad_extensions, wanted) != std::end(cad_extensions))
        throw InvalidInput(fmt::format("{}: {} files need batten::cad: link it and call "
                                       "batten::cad::register_formats() first",
                                       path.string(), wanted));
    throw InvalidInput(fmt::format("{}: unknown extension '{}'; known: {}", path.string(), wanted,
                                   fmt::join(known, ", ")));
}

void register_format(SplineFormat format) {
    registry().push_back(std::move(format));
}

void check_output(const std::filesystem::path& path) {
    spline_format(path);
    output_place(path);
}

void check_holds(const std::filesystem::path& path, Index axes, Index dim) {
    check(spline_format(path).limits, axes, dim);
}

SplineFile read_splines(const std::filesystem::path& path) {
    const SplineFormat& format = spline_format(path);
    if (!format.read)
        throw InvalidInput(
            fmt::format("{}: {} files are written, not read", path.string(), format.extension));
    return format.read(path, read_file(path));
}

Spline one_of(SplineFile file, const std::filesystem::path& path, Index entity) {
    const Index count = std::ssize(file.splines);
    if (entity < 0 || entity > count)
        throw InvalidInput(fmt::format("{}: entity {}: the file holds {} spline{}, counted from 1",
                                       path.string(), entity, count, count == 1 ? "" : "s"));
    if (entity == 0 && count != 1)
        throw InvalidInput(
            fmt::format("{}: it holds {} splines, one is needed: say which, entity 1 "
                        "to {} (a conversion takes them apart)",
                        path.string(), count, count));
    return std::move(file.splines[static_cast<std::size_t>(std::max<Index>(entity, 1) - 1)]);
}

Spline read_spline(const std::filesystem::path& path, Index entity) {
    return one_of(read_splines(path), path, entity);
}

bool is_spline_file(const std::filesystem::path& path) {
    return std::ranges::any_of(registry(), [&](const SplineFormat& format) {
        return format.read && format.extension == extension(path);
    });
}

namespace {

/// What every format relies on.
void check_scene(const Scene& scene) {
    constexpr std::string_view units[] = {"mm", "cm", "m", "in"};
    if (std::ranges::count(units, std::string_view(scene.unit)) == 0)
        throw InvalidInput(unknown_name("unit", scene.unit, units));
    if (!(scene.chord_tolerance >= 0) || !std::isfinite(scene.chord_tolerance))
        throw InvalidInput(
            fmt::format("chord tolerance {}: must be positive and finite, or 0 for a thousandth of "
                        "the size",
                        scene.chord_tolerance));
    if (scene.deviations != nullptr && scene.samples != nullptr &&
        static_cast<Index>(scene.deviations->size()) != scene.samples->size())
        throw InvalidInput(fmt::format("scene: {} deviations given for {} samples",
                                       scene.deviations->size(), scene.samples->size()));
    for (const Spline* spline : scene.splines()) {
        const PointSet& control = spline->control_points();
        for (Index i = 0; i < control.size(); ++i)
            for (double x : control[i])
                if (!std::isfinite(x))
                    throw InvalidInput(fmt::format("spline: control point {} is ({}); only finite "
                                                   "numbers are written",
                                                   i, fmt::join(control[i], ", ")));
    }
}

} // namespace

std::string spline_content(const std::filesystem::path& path, const Scene& scene) {
    const SplineFormat& format = spline_format(path);
    if (!format.several && !scene.more.empty())
        throw InvalidInput(fmt::format("{}: {} files hold one spline, got {}", path.string(),
                                       format.extension, scene.more.size() + 1));
    check_scene(scene);
    return format.write(scene);
}

std::string spline_note(const std::filesystem::path& path, const Scene& scene) {
    const SplineFormat& format = spline_format(path);
    return format.note ? format.note(scene) : std::string();
}

void write_spline(const std::filesystem::path& path, const Scene& scene) {
    write_file(path, spline_content(path, scene));
}

} // namespace batten
