#include "papers.hpp"
#include "peng_li_experiments.hpp"

#include <batten/core/stopwatch.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace batten::command {

namespace {

/// E < 1e-6, E the *square* of the relative gradient; `settings` beside the paper's.
FitResult run(const Experiment& experiment, std::string_view method, Settings settings = {}) {
    FitOptions options = experiment.options;
    options.method.name = method;
    if (method == "alspia") { // the authors' cycle, and their gradients on missing data, too
        settings["cycle"] = 10000;
        settings["row_sums"] = 0;
    }
    if (method == "cg") settings["plain"] = 1;
    if (method == "lspia" || method == "alspia" || method == "mlspia" || method == "nmlspia")
        settings["eigenvalue_tolerance"] = 1e-10;
    options.method.settings = std::move(settings);
    options.stop.relative_gradient = 1e-3;
    return fit(experiment.samples, options);
}

double error(const FitReport& report) { // E, in 1e-7
    const double part = report.gradient_norm / report.first_gradient_norm;
    return 1e7 * part * part;
}

/// A method's figures as printed; "" is not printed.
struct Line {
    const char* method;
    const char *iterations, *error = "", *rms = "", *largest = "";
};

/// Condition number of A, by MLSPIA's best omega = 4 k / (1 + k)^2.
double condition(const FitReport& mlspia) {
    const double omega = mlspia.settings.at("omega");
    return (2 - omega + 2 * std::sqrt(1 - omega)) / omega;
}

/// What was kept and what taken away of an experiment with holes.
struct Counts {
    const char *kept = "", *taken = "";
};

/// Four figures and the time for each method, of the samples or of those that were taken away.
Table compare(const std::string& name, const Experiment& experiment, const char* kappa,
              const std::vector<Line>& lines, const Counts& counts = {}) {
    Table table{name, {}};
    const bool holes = experiment.hole.size() > 0;
    const char* where = holes ? " in the holes" : "";
    const auto deviation = [&](const FitResult& r) {
        return holes ? summarise(parametric_deviations(r.spline, experiment.hole,
                                                       experiment.hole_parameters),
                                 DeviationKind::parametric)
                     : r.report.deviation;
    };
    for (const auto& [method, iterations, e, rms, largest] : lines) {
        const std::string who = fmt::format("{}: ", method);
        Stopwatch clock;
        const FitResult result = run(experiment, method);
        const double seconds = clock.lap();
        const Deviation there = deviation(result);
        if (method == std::string_view("mlspia"))
            table.rows.push_back({"condition number of A", kappa, condition(result.report)});
        if (method != std::string_view("direct")) {
            table.rows.push_back(
                {who + "iterations", iterations, static_cast<double>(result.report.iterations)});
            table.rows.push_back({who + "E in 1e-7", e, error(result.report)});
        }
        table.rows.push_back({who + "rms" + where, rms, there.rms});
        table.rows.push_back({who + "largest" + where, largest, there.maximum});
        table.rows.push_back({who + "seconds, set-up counted", "", seconds});
    }
    if (!holes) return table;
    table.rows.push_back(
        {"samples kept", counts.kept, static_cast<double>(experiment.samples.size())});
    table.rows.push_back({"taken away", counts.taken, static_cast<double>(experiment.hole.size())});
    return table;
}

/// Iterations with their halvings of the ablation's three steps, or of lengths of the memory.
void ablate(const std::string& what, const Experiment& experiment, const Settings& settings,
            const char* iterations, const char* halvings, Table& table) {
    const FitReport report = run(experiment, "salspia", settings).report;
    table.rows.push_back(
        {what + ": iterations", iterations, static_cast<double>(report.iterations)});
    table.rows.push_back({what + ": halvings", halvings, report.settings.at("halvings")});
}

Table ablation(const Experiment& helix) {
    Table table{"Ablation of the step, 4.2", {}};
    ablate("longer step alone", helix, {{"step", 1}}, "4", "0", table);
    ablate("shorter step alone", helix, {{"step", 2}}, "5", "0", table);
    ablate("blended", helix, {}, "4", "0", table);
    return table;
}

Table memories(const Experiment& peaks) {
    Table table{"Lengths of the memory, 4.5", {}};
    for (const double memory : {1, 3, 5, 10, 20})
        ablate(fmt::format("M = {}", memory), peaks, {{"memory", memory}}, "8",
               memory == 1 ? "1" : "0", table);
    return table;
}

/// A grid's triangulation is not unique: neither is the start, nor what depends on it.
Table franke_table() {
    Table table = compare("4.8 Franke with holes", franke_with_holes(), "",
                          {{"lin2018", "40", "9.335", "2.0593e-2", "8.0855e-2"},
                           {"alspia", "53", "9.846", "2.9800e-2", "8.4408e-2"},
                           {"salspia", "14", "7.606", "2.9726e-2", "8.4407e-2"},
                           {"cg", ""}},
                          {"8627", "1574"});
    table.data = Data::stand_in;
    table.why = "a start over another of Delaunay's triangulations";
    return table;
}

Table mount_eden_table(const Workshop& workshop) {
    const char* const name = "4.6 terrain";
    const char* const file = "mteden860x600.npy";
    const std::optional<PointSet> heights = workshop.real_table(file);
    if (!heights) return {name, {}, Data::none, fmt::format("{} is not in --data", file)};
    Table table = compare(name, over_grid(mount_eden(*heights), 121), "22.2401",
                          {{"lspia", "1262", "9.942"},
                           {"alspia", "33", "9.743"},
                           {"mlspia", "114", "8.990"},
                           {"nmlspia", "23", "9.604"},
                           {"salspia", "13", "4.424", "9.8835e-2", "9.2979e-1"},
                           {"cg", ""},
                           {"direct", ""}});
    table.data = Data::stand_in;
    table.why = "another resampling of the same heights";
    return table;
}

/// Whether a parameter is within 0.02 of one of the centres.
auto near(std::vector<double> centres) {
    return [centres = std::move(centres)](std::span<const double> t) {
        return std::ranges::any_of(centres,
                                   [&](double c) { return t[0] >= c - 0.02 && t[0] <= c + 0.02; });
    };
}

} // namespace

std::vector<Table> peng_li(Workshop& workshop) {
    const Experiment helix_10001 = along_curve(helix(2 * std::numbers::pi, 10001), 2001);
    const Experiment peaks_121 = over_grid(peaks_over_8(), 41);
    Experiment blob_holes = along_curve(blob(331), 101);
    take_away(blob_holes, near({0.20, 0.42, 0.62, 0.82}));
    Experiment helix_holes = along_curve(helix(30, 521), 201);
    take_away(helix_holes, near({0.25, 0.50, 0.75}));
    const char* const private_data = "the authors' points are not to be had";
    std::vector<Table> tables;
    tables.push_back(compare("4.1 blob", along_curve(blob(15001), 3001), "4.71915",
                             {{"lspia", "77", "9.336", "1.073e-5", "2.552e-5"},
                              {"alspia", "6", "9.415", "2.383e-5", "1.081e-3"},
                              {"mlspia", "25", "7.338", "9.510e-6", "2.288e-5"},
                              {"nmlspia", "5", "9.739", "1.763e-5", "5.298e-4"},
                              {"salspia", "4", "8.164", "2.279e-5", "1.135e-3"},
                              {"cg", ""},
                              {"direct", ""}}));
    tables.push_back(compare("4.2 helix", helix_10001, "4.72286",
                             {{"lspia", "77", "9.646", "2.084e-5", "3.836e-5"},
                              {"alspia", "7", "6.292", "3.859e-5", "1.503e-3"},
                              {"mlspia", "25", "7.736", "1.867e-5", "3.482e-5"},
                              {"nmlspia", "6", "3.595", "2.235e-5", "5.400e-4"},
                              {"salspia", "4", "9.155", "4.615e-5", "1.875e-3"},
                              {"cg", ""},
                              {"direct", ""}}));
    tables.push_back(compare("4.4 Dini", over_grid(dini(), 31), "21.1619",
                             {{"lspia", "213", "9.756", "3.383e-4", "9.728e-4"},
                              {"alspia", "37", "9.188", "1.273e-3", "2.323e-2"},
                              {"mlspia", "82", "6.922", "3.110e-4", "1.010e-3"},
                              {"nmlspia", "30", "8.664", "9.507e-4", "4.707e-3"},
                              {"salspia", "14", "3.371", "6.246e-4", "1.231e-2"},
                              {"cg", ""},
                              {"direct", ""}}));
    tables.push_back(compare("4.5 peaks", peaks_121, "21.2209",
                             {{"lspia", "1091", "9.942", "3.408e-4", "1.892e-3"},
                              {"alspia", "15", "8.701", "7.832e-4", "1.128e-2"},
                              {"mlspia", "109", "8.394", "3.248e-4", "1.862e-3"},
                              {"nmlspia", "17", "8.722", "6.446e-4", "5.182e-3"},
                              {"salspia", "8", "5.731", "5.827e-4", "7.983e-3"},
                              {"cg", ""},
                              {"direct", ""}}));
    tables.push_back(compare("4.1 with holes", blob_holes, "",
                             {{"lin2018", "18", "9.349", "7.273e-2", "0.18066"},
                              {"alspia", "38", "9.624", "0.11878", "0.22715"},
                              {"salspia", "14", "4.402", "0.11536", "0.22019"},
                              {"cg", ""}},
                             {"267", "64"}));
    tables.push_back(compare("4.2 with holes", helix_holes, "",
                             {{"lin2018", "26", "8.705", "0.48286", "1.1494"},
                              {"alspia", "32", "9.064", "0.64879", "1.1977"},
                              {"salspia", "14", "7.512", "0.64236", "1.1959"},
                              {"cg", ""}},
                             {"458", "63"}));
    tables.push_back(franke_table());
    tables.push_back(mount_eden_table(workshop));
    tables.push_back({"4.3 reindeer", {}, Data::none, private_data});
    tables.push_back({"4.7 loop with holes", {}, Data::none, private_data});
    tables.push_back(ablation(helix_10001));
    tables.push_back(memories(peaks_121));
    return tables;
}

} // namespace batten::command
