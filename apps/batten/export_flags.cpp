#include "export_flags.hpp"
#include "parse.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

namespace batten::command {

namespace {

/// YYYY-MM-DDTHH:MM:SS, each part in its range.
bool is_date(const std::string& text) {
    constexpr std::string_view pattern = "dddd-dd-ddTdd:dd:dd";
    if (text.size() != pattern.size()) return false;
    for (std::size_t k = 0; k < text.size(); ++k)
        if (pattern[k] == 'd' ? !(text[k] >= '0' && text[k] <= '9') : text[k] != pattern[k])
            return false;
    const auto part = [&](std::size_t at) { return 10 * (text[at] - '0') + text[at + 1] - '0'; };
    return part(5) >= 1 && part(5) <= 12 && part(8) >= 1 && part(8) <= 31 && part(11) < 24 &&
           part(14) < 60 && part(17) < 60;
}

/// Extensions of the formats that show it.
std::string showing(SceneDetail detail) {
    std::string list;
    for (const SplineFormat& format : spline_formats())
        if (format.shows == detail)
            list += fmt::format("{}{}", list.empty() ? "" : ", ", format.extension);
    return list;
}

} // namespace

void add_export_flags(CLI::App& app, ExportFlags& flags) {
    app.add_option("--unit", flags.unit,
                   "Unit of the coordinates in CAD files and pages: mm, cm, m or in")
        ->check(CLI::IsMember({"mm", "cm", "m", "in"}))
        ->group("Output")
        ->capture_default_str();
    app.add_option("--chord-tolerance", flags.chord_tolerance,
                   "How far .stl, .vtu, .vts and .csv may be from the spline (a thousandth of its "
                   "size)")
        ->check(positive())
        ->group("Output");
    app.add_option("--date", flags.date,
                   "Date in CAD headers, 2026-01-31T12:00:00 (a fixed one: equal fits give equal "
                   "bytes)")
        ->group("Output");
}

void check(const ExportFlags& flags, const CLI::App& app, const std::vector<std::string>& outputs,
           const std::string& report) {
    const auto needs = [&](const char* flag, SceneDetail detail, std::string_view others = "") {
        const bool shown = std::ranges::any_of(outputs, [&](const std::string& output) {
            return spline_format(output).shows == detail;
        });
        if (app.count(flag) > 0 && !shown)
            throw InvalidInput(fmt::format("{}: it is for {}{}", flag, showing(detail), others));
    };
    const bool has_page = app.get_option_no_throw("--report") != nullptr;
    // a conversion may say of any spline what its coordinates are
    if (has_page && report.empty()) needs("--unit", SceneDetail::unit_and_date, ", --report");
    needs("--date", SceneDetail::unit_and_date);
    needs("--chord-tolerance", SceneDetail::chord_tolerance);
    if (!flags.date.empty() && !is_date(flags.date))
        throw InvalidInput(
            fmt::format("--date {}: a date like 2026-01-31T12:00:00 is needed", flags.date));
}

void apply(const ExportFlags& flags, Scene& scene) {
    scene.unit = flags.unit;
    scene.chord_tolerance = flags.chord_tolerance;
    scene.date = flags.date;
}

void print_notes(const std::vector<std::string>& outputs, const Scene& scene) {
    for (const std::string& output : outputs)
        if (const std::string note = spline_note(output, scene); !note.empty())
            std::fputs(fmt::format("batten: {}: {}\n", output, note).c_str(), stderr);
}

} // namespace batten::command
