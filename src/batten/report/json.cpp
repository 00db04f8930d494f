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
    for (const HistoryEntry& entry : history)
        rows.push_back({{"iteration", entry.iteration},
                        {"gradient_norm", number(entry.gradient_norm)},
                        {"largest_move", number(entry.largest_move)},
                        {"max_deviation", number(entry.max_deviation)},
                        {"constraint_error", number(entry.constraint_error)}});
    return rows;
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
    if (method != "direct") {
        json["gradient_norm"] = number(gradient_norm);
        json["first_gradient_norm"] = number(first_gradient_norm);
        if (predicted_rate > 0) json["predicted_rate"] = predicted_rate;
        if (observed_rate > 0) json["observed_rate"] = observed_rate;
    }
    if (interpolated > 0) {
        json["interpolated"] = interpolated;
        json["constraint_error"] = number(constraint_error);
    }
    if (smoothing > 0) json["smoothing"] = smoothing;
    if (freedom > 0) {
        json["degrees_of_freedom"] = freedom;
        json["noise_level"] = number(noise_level);
    }
    if (!set_aside.empty()) json["set_aside"] = set_aside;
    if (tangents > 0) {
        json["tangents"] = tangents;
        json["tangent_error"] = number(tangent_error);
    }
    if (boundaries > 0) json["boundaries"] = boundaries;
    if (inflections >= 0) json["inflections"] = inflections;
    if (curve_inflections >= 0) {
        json["curve_inflections"] = curve_inflections;
        json["data_inflections"] = data_inflections;
    }
    if (tolerance > 0) {
        json["tolerance"] = tolerance;
        json["verdict"] = verdict;
        if (noise_level > 0) json["noise_level"] = number(noise_level);
        if (between_samples > 0) json["between_samples"] = number(between_samples);
        json["stages"] = Json::object();
        for (const auto& [stage, count] : stages) json["stages"][stage] = count;
    }
    json["data_size"] = data_size;
    json["seconds"] = Json::object();
    for (const auto& [stage, time] : seconds) json["seconds"][stage] = time;
    json["seconds"]["total"] = total_seconds();
    if (!notes.empty()) json["notes"] = notes;
    if (!history.empty()) json["history"] = history_json(history);
    return json.dump(2) + "\n";
}

} // namespace batten
