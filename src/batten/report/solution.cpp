#include <batten/fit/solve_system.hpp>
#include <batten/report/words.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace batten {

std::string SolveReport::full() const {
    constexpr double few_digits = 8;
    const std::string_view mean = weighted ? "weighted rms" : "rms";
    const double told = std::max(rms, rms_rounding);
    std::string text =
        fmt::format("{} of degree {}, {} control points{}: {} samples, {} {}{:.4g}\n", kind,
                    fmt::join(degree, "x"), fmt::join(control_shape, "x"), closed_axes(closures),
                    samples, mean, rms_known() ? "" : "below ", told);
    const auto line = [&](std::string_view name, const std::string& words) {
        text += fmt::format("  {:<12}{}\n", name, words);
    };
    line("deviation", fmt::format("{} {}{:.6g}{}, {}; the largest is not known without the samples",
                                  mean, rms_known() ? "" : "below ", told,
                                  rms_known() ? "" : ", the rounding of the saved sums",
                                  percentage(told, data_size)));
    line("method", "direct (from the saved system)");
    if (control_shape != assembled_shape)
        line("knots", fmt::format("nested in those of the saved system, {} control points",
                                  fmt::join(assembled_shape, "x")));
    if (smoothing > 0) line("smoothing", fmt::format("lambda {:.4g}", smoothing));
    line("seconds", fmt::format("{:.3g}", seconds));
    if (digits < few_digits)
        line("note", fmt::format("the normal equations leave about {:.0f} digits to the control "
                                 "points; a fit of the samples may have more",
                                 std::max(digits, 0.0)));
    return text;
}

std::string SolveReport::to_json() const {
    nlohmann::ordered_json json;
    json["kind"] = kind;
    json["samples"] = samples;
    json["dim"] = dim;
    json["degree"] = degree;
    json["control_shape"] = control_shape;
    json["assembled_shape"] = assembled_shape;
    std::vector<bool> closed;
    for (const Closure closure : closures) closed.push_back(closure == Closure::closed);
    json["closed"] = closed;
    json["method"] = "direct";
    json[weighted ? "weighted_rms_deviation" : "rms_deviation"] = rms;
    json["rms_rounding"] = rms_rounding;
    json["data_size"] = data_size;
    if (smoothing > 0) json["smoothing"] = smoothing;
    json["digits"] = digits;
    json["seconds"] = {{"total", seconds}};
    return json.dump(2) + "\n";
}

} // namespace batten
