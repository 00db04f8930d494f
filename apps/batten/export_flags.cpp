#include "export_flags.hpp"

namespace batten::command {

void add_export_flags(CLI::App& app, ExportFlags& flags) {
    app.add_option("--unit", flags.unit, "Unit of the coordinates in CAD files: mm, cm, m or in")
        ->check(CLI::IsMember({"mm", "cm", "m", "in"}))
        ->group("Output")
        ->capture_default_str();
    app.add_option("--chord-tolerance", flags.chord_tolerance,
                   "How far .stl, .vtu, .vts and .csv may be from the spline (a thousandth of its "
                   "size)")
        ->check(CLI::PositiveNumber)
        ->group("Output");
    app.add_option("--date", flags.date,
                   "Date in CAD headers, 2026-01-31T12:00:00 (a fixed one: equal fits give equal "
                   "bytes)")
        ->group("Output");
}

void apply(const ExportFlags& flags, Scene& scene) {
    scene.unit = flags.unit;
    scene.chord_tolerance = flags.chord_tolerance;
    scene.date = flags.date;
}

} // namespace batten::command
