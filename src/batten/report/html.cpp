#include <batten/report/html.hpp>

#include <batten/io/graph_scene.hpp>
#include <batten/spline/graph.hpp>

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

/// Where coordinates are drawn: relative to the centre, each times its factor.
struct Stage {
    std::vector<double> centre;
    std::vector<double> stretch;
    double at(double x, Index d) const {
        const auto k = static_cast<std::size_t>(d);
        return (x - centre[k]) * stretch[k];
    }
};

/// Coordinates as they are drawn, in single precision, little-endian as all who read pages are.
std::string packed(const Points& points, const Stage& stage) {
    std::vector<float> values;
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < points.dim(); ++d)
            values.push_back(static_cast<float>(stage.at(points(i, d), d)));
    return base64(values.data(), values.size() * sizeof(float));
}

Json spline_data(const Spline& spline, const Stage& stage) {
    Json json;
    json["degree"] = Json::array();
    json["knots"] = Json::array();
    for (const KnotVector& axis : spline.axes()) {
        json["degree"].push_back(axis.degree());
        json["knots"].push_back(std::vector<double>(axis.knots().begin(), axis.knots().end()));
    }
    json["shape"] = spline.control_shape();
    json["dim"] = spline.dim();
    json["control"] = packed(spline.control_points(), stage);
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

Json sample_data(const FitReport& report, const Scene& scene, Index most, const Points& points,
                 const Stage& stage) {
    Json json;
    if (points.size() <= most) {
        json["shown"] = nullptr;
        json["samples"] = packed(points, stage);
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
    json["samples"] = packed(some, stage);
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

Json frame_data(const FitReport& report, const Spline& spline, const Stage& stage) {
    Json frames = Json::array();
    const Index own = spline.free_control_points().size();
    for (const Frame& frame : report.frames)
        if (frame.control.size() == own) // those before a knot came in have another shape
            frames.push_back(
                {{"iteration", frame.iteration},
                 {"control",
                  packed(drawn(Spline::from_free(spline.axes(), frame.control)).control_points(),
                         stage)}});
    if (!frames.empty())
        frames.push_back({{"iteration", report.iterations},
                          {"control", packed(drawn(spline).control_points(), stage)}});
    return frames;
}

Stage stage_of(const PointSet& samples, const Spline& shown, bool function) {
    const PointSet box = bounding_box(samples);
    Stage stage;
    for (Index d = 0; d < box.dim(); ++d) stage.centre.push_back((box(0, d) + box(1, d)) / 2);
    stage.stretch = function ? picture_stretch(shown) : std::vector<double>(stage.centre.size(), 1);
    return stage;
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
    const bool function = is_function(scene.spline);
    const Spline shown = drawn(scene.spline);
    check(page_limits, scene.spline.axis_count(), scene.spline.dim());
    const PointSet samples = drawn_samples(scene);
    if (samples.empty())
        throw InvalidInput("a report page of a function needs its samples' parameters");
    const Stage stage = stage_of(samples, shown, function);
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
    data["dim"] = shown.dim();
    data["graph"] = function;
    data["centre"] = stage.centre;
    data["stretch"] = stage.stretch;
    data.update(sample_data(report, scene, options.most_samples, samples, stage));
    data["spline"] = spline_data(shown, stage);
    data["frames"] = frame_data(report, scene.spline, stage);
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
