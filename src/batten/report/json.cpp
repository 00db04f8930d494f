#include <batten/problem/report.hpp>

#include <cmath>
#include <nlohmann/json.hpp>

namespace batten {

namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
    return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json history_json(const std::vector<HistoryEntry>& history) {
    Json rows = Json::array();
    for (const HistoryEntry& entry : history) {
        Json row{{"iteration", entry.iteration},
                 {"gradient_norm", number(entry.gradient_norm)},
                 {"largest_move", number(entry.largest_move)},
                 {"max_deviation", number(entry.max_deviation)},
                 {"constraint_error", number(entry.constraint_error)}};
        if (entry.control_points > 0) {
            row["control_points"] = entry.control_points;
            row["largest_mean"] = number(entry.largest_mean);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

/// What no number says, as by how much a tangent turned round is missed, is left out.
Json goals_json(const std::vector<Goal>& goals) {
    Json rows = Json::array();
    for (const Goal& goal : goals) {
        Json row{{"goal", goal.name}, {"stated", number(goal.stated)}};
        if (std::isfinite(goal.reached)) row["reached"] = goal.reached;
        row["met"] = goal.met;
        rows.push_back(std::move(row));
    }
    return rows;
}

void add_course(Json& json, const FitReport& r) {
    if (!r.iterated()) return;
    json["gradient_norm"] = number(r.gradient_norm);
    json["first_gradient_norm"] = number(r.first_gradient_norm);
    if (r.predicted_rate > 0) json["predicted_rate"] = r.predicted_rate;
    if (r.observed_rate > 0) json["observed_rate"] = r.observed_rate;
}

void add_held(Json& json, const FitReport& r) {
    if (r.interpolated > 0) {
        json["interpolated"] = r.interpolated;
        json["constraint_error"] = number(r.constraint_error);
    }
    if (r.tangents > 0) {
        json["tangents"] = r.tangents;
        if (std::isfinite(r.tangent_error)) json["tangent_error"] = r.tangent_error;
    }
    if (r.boundaries > 0) {
        json["boundaries"] = r.boundaries;
        json["boundary_error"] = number(r.boundary_error);
    }
    if (r.inflections >= 0) json["inflections"] = r.inflections;
    if (r.allowed_inflections >= 0) json["allowed_inflections"] = r.allowed_inflections;
    if (r.held_back > 0) json["held_back"] = r.held_back;
    if (r.curve_inflections >= 0) {
        json["curve_inflections"] = r.curve_inflections;
        json["data_inflections"] = r.data_inflections;
    }
}

void add_noise(Json& json, const FitReport& r) {
    if (r.smoothing > 0) json["smoothing"] = r.smoothing;
    if (r.freedom > 0) json["degrees_of_freedom"] = r.freedom;
    if (r.noise_level > 0) json["noise_level"] = number(r.noise_level);
    if (!r.set_aside.empty()) json["set_aside"] = r.set_aside;
}

void add_tolerance(Json& json, const FitReport& r) {
    if (!(r.tolerance > 0)) return;
    json["tolerance"] = r.tolerance;
    json["tolerance_ratio"] = number(r.tolerance_ratio);
    if (r.largest_tolerance > 0) json["largest_tolerance"] = r.largest_tolerance;
    json["verdict"] = r.verdict;
    if (r.between_samples > 0) json["between_samples"] = number(r.between_samples);
    json["stages"] = Json::object();
    for (const auto& [stage, count] : r.stages) json["stages"][stage] = count;
    if (r.searched_samples > 0) {
        json["searched_samples"] = r.searched_samples;
        json["full_checks"] = r.full_checks;
    }
}

} // namespace

std::string FitReport::to_json() const {
    Json json;
    json["kind"] = kind;
    json["samples"] = samples;
    json["dim"] = dim;
    json["degree"] = degree;
    json["control_shape"] = control_shape;
    json["closed"] = Json::array();
    for (Closure closure : closures) json["closed"].push_back(closure == Closure::closed);
    json["method"] = method;
    if (!method_reason.empty()) json["method_reason"] = method_reason;
    json["settings"] = Json::object();
    for (const auto& [name, value] : settings) json["settings"][name] = number(value);
    json["iterations"] = iterations;
    json["termination"] = to_string(termination);
    json["max_deviation"] = number(deviation.maximum);
    json["rms_deviation"] = number(deviation.rms);
    json["worst_sample"] = deviation.worst_sample;
    json["deviation_kind"] = to_string(deviation.kind);
    if (!goals.empty()) json["goals"] = goals_json(goals);
    add_course(json, *this);
    add_held(json, *this);
    add_noise(json, *this);
    add_tolerance(json, *this);
    json["data_size"] = data_size;
    json["seconds"] = Json::object();
    for (const auto& [stage, time] : seconds) json["seconds"][stage] = time;
    json["seconds"]["total"] = total_seconds();
    if (passes > 0) json["passes"] = passes;
    if (bytes_read > 0) json["bytes_read"] = bytes_read;
    if (!notes.empty()) json["notes"] = notes;
    if (!history.empty()) json["history"] = history_json(history);
    return json.dump(2) + "\n";
}

} // namespace batten
