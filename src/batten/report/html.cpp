#include <batten/report/html.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

// The page that viewer/ builds, its data a placeholder.
asm(".section .rodata\n"
    ".global batten_page_begin\n"
    ".global batten_page_end\n"
    "batten_page_begin:\n"
    ".incbin \"" BATTEN_PAGE "\"\n"
    "batten_page_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const char batten_page_begin[];
extern "C" const char batten_page_end[];

namespace batten {

namespace {

using Json = nlohmann::ordered_json;

std::string base64(const void* data, std::size_t bytes) {
    constexpr const char* letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto* in = static_cast<const unsigned char*>(data);
    std::string out;
    out.reserve((bytes + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes; i += 3) {
        unsigned value = 0;
        for (std::size_t k = 0; k < 3; ++k) value = value << 8U | (i + k < bytes ? in[i + k] : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k <= bytes ? letters[value >> (18 - 6 * k) & 63U] : '=';
    }
    return out;
}

/// Coordinates relative to the centre, in single precision, little-endian as all who read pages
/// are.
std::string packed(const Points& points, const std::vector<double>& centre) {
    std::vector<float> values;
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < points.dim(); ++d)
            values.push_back(
                static_cast<float>(points(i, d) - centre[static_cast<std::size_t>(d)]));
    return base64(values.data(), values.size() * sizeof(float));
}

Json spline_data(const Spline& spline, const std::vector<double>& centre) {
    Json json;
    json["degree"] = Json::array();
    json["knots"] = Json::array();
    for (const KnotVector& axis : spline.axes()) {
        json["degree"].push_back(axis.degree());
        json["knots"].push_back(std::vector<double>(axis.knots().begin(), axis.knots().end()));
    }
    json["shape"] = spline.control_shape();
    json["dim"] = spline.dim();
    json["control"] = packed(spline.control_points(), centre);
    return json;
}

/// The samples that are shown: all, or evenly some with the worst among them.
std::vector<Index> shown_samples(Index count, Index most, Index worst) {
    std::vector<Index> shown;
    const Index stride = (count + most - 1) / most;
    for (Index i = 0; i < count; i += stride) {
        if (worst > i - stride && worst < i) shown.push_back(worst);
        shown.push_back(i);
    }
    if (worst > shown.back()) shown.push_back(worst);
    return shown;
}

Json sample_data(const FitReport& report, const Scene& scene, Index most,
                 const std::vector<double>& centre) {
    const Points& points = scene.samples->points;
    Json json;
    if (points.size() <= most) {
        json["shown"] = nullptr;
        json["samples"] = packed(points, centre);
        const std::vector<float> deviations(scene.deviations->begin(), scene.deviations->end());
        json["deviations"] = base64(deviations.data(), deviations.size() * sizeof(float));
        return json;
    }
    std::vector<std::int32_t> indices;
    std::vector<float> deviations;
    PointSet some(0, points.dim());
    for (Index i : shown_samples(points.size(), most, report.deviation.worst_sample)) {
        indices.push_back(static_cast<std::int32_t>(i));
        deviations.push_back(static_cast<float>((*scene.deviations)[static_cast<std::size_t>(i)]));
        some.values().insert(some.values().end(), points[i].begin(), points[i].end());
    }
    some = PointSet(std::move(some.values()), points.dim());
    json["shown"] = base64(indices.data(), indices.size() * sizeof(std::int32_t));
    json["samples"] = packed(some, centre);
    json["deviations"] = base64(deviations.data(), deviations.size() * sizeof(float));
    return json;
}

Json history_data(const FitReport& report) {
    if (report.history.empty()) return nullptr;
    Json json;
    for (const char* name : {"iteration", "gradient", "deviation"}) json[name] = Json::array();
    for (const HistoryEntry& entry : report.history) {
        json["iteration"].push_back(entry.iteration);
        json["gradient"].push_back(entry.gradient_norm);
        json["deviation"].push_back(entry.max_deviation);
    }
    return json;
}

Json frame_data(const FitReport& report, const Spline& spline, const std::vector<double>& centre) {
    Json frames = Json::array();
    const Index own = spline.free_control_points().size();
    for (const Frame& frame : report.frames)
        if (frame.control.size() == own) // those before a knot came in have another shape
            frames.push_back(
                {{"iteration", frame.iteration},
                 {"control",
                  packed(Spline::from_free(spline.axes(), frame.control).control_points(),
                         centre)}});
    if (!frames.empty())
        frames.push_back({{"iteration", report.iterations},
                          {"control", packed(spline.control_points(), centre)}});
    return frames;
}

std::string plain_words(Termination termination) {
    std::string words(to_string(termination));
    std::ranges::replace(words, '_', ' ');
    return words;
}

/// JSON that may stand in a script element: no `<` that could end it.
std::string for_page(const Json& json) {
    const std::string text =
        json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    std::string result;
    result.reserve(text.size());
    for (char c : text) {
        if (c == '<')
            result += "\\u003c";
        else
            result += c;
    }
    return result;
}

} // namespace

std::string html_page(const FitReport& report, const Scene& scene, const PageOptions& options) {
    if (scene.samples == nullptr || scene.deviations == nullptr)
        throw InvalidInput("a report page needs the samples and their deviations");
    if (scene.spline.dim() > 3)
        throw InvalidInput(fmt::format("a report page shows curves, surfaces and volumes in space, "
                                       "this spline is of dimension {}",
                                       scene.spline.dim()));
    const PointSet box = bounding_box(scene.samples->points);
    std::vector<double> centre;
    for (Index d = 0; d < box.dim(); ++d) centre.push_back((box(0, d) + box(1, d)) / 2);
    const bool judged = report.tolerance > 0;
    Json data;
    data["title"] = scene.title;
    data["brief"] = report.brief();
    data["command"] = options.command;
    data["words"] = report.lines();
    data["met"] = judged ? Json(report.termination == Termination::tolerance_met) : Json(nullptr);
    data["verdict"] = judged ? fmt::format("Tolerance {:.6g}: {}", report.tolerance, report.verdict)
                             : plain_words(report.termination);
    data["kind"] = report.kind;
    data["unit"] = options.unit;
    data["tolerance"] = report.tolerance;
    data["maximum"] = report.deviation.maximum;
    data["rms"] = report.deviation.rms;
    data["worst"] = report.deviation.worst_sample;
    data["count"] = scene.samples->size();
    data["dim"] = scene.spline.dim();
    data["centre"] = centre;
    data.update(sample_data(report, scene, options.most_samples, centre));
    data["spline"] = spline_data(scene.spline, centre);
    data["frames"] = frame_data(report, scene.spline, centre);
    data["history"] = history_data(report);
    const std::string_view page(batten_page_begin,
                                static_cast<std::size_t>(batten_page_end - batten_page_begin));
    constexpr std::string_view placeholder = "BATTEN_REPORT_DATA";
    const std::size_t at = page.find(placeholder);
    if (at == std::string_view::npos) throw SolverError("the embedded page has no place for data");
    return fmt::format("{}{}{}", page.substr(0, at), for_page(data),
                       page.substr(at + placeholder.size()));
}

} // namespace batten
