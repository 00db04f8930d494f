#include <batten/problem/report.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

std::string percentage(double part, double whole) {
    return whole > 0 ? fmt::format("{:.3g} % of the data's size", 100 * part / whole)
                     : std::string("the data have no size");
}

std::string closed_axes(const std::vector<Closure>& closures) {
    std::vector<std::size_t> closed;
    for (std::size_t k = 0; k < closures.size(); ++k)
        if (closures[k] == Closure::closed) closed.push_back(k);
    if (closed.empty()) return "";
    return closures.size() == 1 ? ", closed"
                                : fmt::format(", closed along axis {}", fmt::join(closed, ", "));
}

} // namespace

double FitReport::total_seconds() const {
    double total = 0;
    for (const auto& [stage, time] : seconds) total += time;
    return total;
}

std::string FitReport::brief() const {
    std::vector<Index> shape = control_shape;
    for (std::size_t k = 0; k < shape.size(); ++k)
        if (closures[k] == Closure::closed) shape[k] -= degree[k];
    return fmt::format(
        "{} of degree {}, {} control points{}: {} samples within {:.4g} (rms {:.4g}), {}", kind,
        fmt::join(degree, "x"), fmt::join(shape, "x"), closed_axes(closures),
        set_aside.empty()
            ? std::to_string(samples)
            : fmt::format("{} of {}", samples - static_cast<Index>(set_aside.size()), samples),
        deviation.maximum, deviation.rms, to_string(termination));
}

std::string FitReport::full() const {
    std::string text = brief() + "\n";
    for (const auto& [name, value] : lines()) text += fmt::format("  {:<12}{}\n", name, value);
    return text;
}

std::vector<std::pair<std::string, std::string>> FitReport::lines() const {
    std::vector<std::pair<std::string, std::string>> result;
    const auto line = [&](std::string_view name, const std::string& value) {
        result.emplace_back(name, value);
    };
    line("deviation", fmt::format("largest {:.6g} at sample {} ({}), {}", deviation.maximum,
                                  deviation.worst_sample, to_string(deviation.kind),
                                  percentage(deviation.maximum, data_size)));
    if (tolerance > 0) {
        line("tolerance", fmt::format("{:.6g}: {}", tolerance, verdict));
        std::string counts;
        for (const auto& [stage, count] : stages)
            counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", stage, count);
        if (!counts.empty()) line("control", counts);
    }
    line("method", method_reason.empty() ? method : fmt::format("{} ({})", method, method_reason));
    if (method != "direct" && method != "tolerance") {
        std::string chosen;
        for (const auto& [name, value] : settings)
            chosen += fmt::format("{}{} = {:.12g}", chosen.empty() ? "" : ", ", name, value);
        if (!chosen.empty()) line("settings", chosen);
        line("iterations", fmt::format("{}, gradient {:.3g} of {:.3g} at the start", iterations,
                                       gradient_norm, first_gradient_norm));
        if (predicted_rate > 0 && observed_rate > 0)
            line("rate", fmt::format("{:.4f} per iteration observed, {:.4f} predicted",
                                     observed_rate, predicted_rate));
    }
    if (smoothing > 0)
        line("smoothing",
             fmt::format("lambda {:.4g}{}", smoothing,
                         freedom > 0
                             ? fmt::format(" by cross-validation, {:.1f} degrees of freedom, "
                                           "noise level {:.3g}",
                                           freedom, noise_level)
                             : ""));
    if (!set_aside.empty()) {
        const std::size_t shown = std::min<std::size_t>(set_aside.size(), 12);
        line("set aside",
             fmt::format(
                 "{} samples as outliers: {}{}", set_aside.size(),
                 fmt::join(set_aside.begin(), set_aside.begin() + static_cast<Index>(shown), ", "),
                 shown < set_aside.size() ? ", ..." : ""));
    }
    if (interpolated > 0)
        line(
            "exact",
            constraint_error <= 1e-8 * data_size
                ? fmt::format("{} samples hit to {:.2g}", interpolated, constraint_error)
                : fmt::format("{} samples NOT hit yet: missed by up to {:.2g}; more iterations, or "
                              "--method direct",
                              interpolated, constraint_error));
    if (tangents > 0)
        line("exact", fmt::format("{} {} held to {:.2g}", tangents,
                                  tangents == 1 ? "tangent" : "tangents", tangent_error));
    if (boundaries > 0)
        line("exact",
             fmt::format("{} {} held", boundaries, boundaries == 1 ? "boundary" : "boundaries"));
    if (inflections >= 0)
        line("shape", tolerance > 0
                          ? fmt::format("{} inflections in the control polygon, {} in the samples",
                                        inflections, data_inflections)
                          : fmt::format("{} inflections in the control polygon", inflections));
    std::string times;
    for (const auto& [stage, time] : seconds)
        times += fmt::format("{}{} {:.2g}", times.empty() ? "" : ", ", stage, time);
    line("seconds", fmt::format("{:.3g} ({})", total_seconds(), times));
    for (const std::string& note : notes) line("note", note);
    return result;
}

} // namespace batten
