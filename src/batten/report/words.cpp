#include <batten/report/words.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

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

double FitReport::total_seconds() const {
    double total = 0;
    for (const auto& [stage, time] : seconds) total += time;
    return total;
}

bool FitReport::goals_met() const {
    return std::ranges::all_of(goals, [](const Goal& goal) { return goal.met; });
}

std::string FitReport::brief() const {
    return fmt::format(
        "{} of degree {}, {} control points{}: {} samples within {:.4g} (rms {:.4g}), {}", kind,
        fmt::join(degree, "x"), fmt::join(control_shape, "x"), closed_axes(closures),
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

namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;

std::string tolerance_words(const FitReport& r) {
    if (!(r.largest_tolerance > 0)) return fmt::format("{:.6g}: {}", r.tolerance, r.verdict);
    return fmt::format("{:.6g} to {:.6g}, of its own a sample uses {:.3g} at most: {}", r.tolerance,
                       r.largest_tolerance, r.tolerance_ratio, r.verdict);
}

Lines closeness(const FitReport& r) {
    Lines lines{
        {"deviation", fmt::format("largest {:.6g} at sample {} ({}), {}", r.deviation.maximum,
                                  r.deviation.worst_sample, to_string(r.deviation.kind),
                                  percentage(r.deviation.maximum, r.data_size))}};
    if (!(r.tolerance > 0)) return lines;
    lines.emplace_back("tolerance", tolerance_words(r));
    std::string counts;
    for (const auto& [stage, count] : r.stages)
        counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", stage, count);
    if (!counts.empty()) lines.emplace_back("control", counts);
    if (r.searched_samples > 0)
        lines.emplace_back("search", fmt::format("by {} samples, checked by all {} times",
                                                 r.searched_samples, r.full_checks));
    return lines;
}

Lines course(const FitReport& r) {
    Lines lines{{"method", r.method_reason.empty()
                               ? r.method
                               : fmt::format("{} ({})", r.method, r.method_reason)}};
    if (!r.iterated()) return lines;
    std::string chosen;
    for (const auto& [name, value] : r.settings)
        chosen += fmt::format("{}{} = {:.12g}", chosen.empty() ? "" : ", ", name, value);
    if (!chosen.empty()) lines.emplace_back("settings", chosen);
    lines.emplace_back("iterations",
                       fmt::format("{}, gradient {:.3g} of {:.3g} at the start", r.iterations,
                                   r.gradient_norm, r.first_gradient_norm));
    if (r.predicted_rate > 0 && r.observed_rate > 0)
        lines.emplace_back("rate", fmt::format("{:.4f} per iteration observed, {:.4f} predicted",
                                               r.observed_rate, r.predicted_rate));
    return lines;
}

Lines noise(const FitReport& r) {
    Lines lines;
    if (r.smoothing > 0)
        lines.emplace_back("smoothing",
                           fmt::format("lambda {:.4g}{}", r.smoothing,
                                       r.freedom > 0
                                           ? fmt::format(" by cross-validation, {:.1f} degrees of "
                                                         "freedom, noise level {:.3g}",
                                                         r.freedom, r.noise_level)
                                           : ""));
    if (r.set_aside.empty()) return lines;
    const std::size_t shown = std::min<std::size_t>(r.set_aside.size(), 12);
    lines.emplace_back("set aside",
                       fmt::format("{} samples as outliers: {}{}", r.set_aside.size(),
                                   fmt::join(r.set_aside.begin(),
                                             r.set_aside.begin() + static_cast<Index>(shown), ", "),
                                   shown < r.set_aside.size() ? ", ..." : ""));
    return lines;
}

/// How exactly holds what must: "held" only when it is.
std::string held_words(Index count, std::string_view one, std::string_view many,
                       std::string_view held, const FitReport& r, std::string_view goal,
                       double error) {
    const bool met =
        std::ranges::all_of(r.goals, [&](const Goal& g) { return g.name != goal || g.met; });
    const std::string_view noun = count == 1 ? one : many;
    if (!std::isfinite(error)) return fmt::format("{} {} missed, turned round", count, noun);
    return fmt::format("{} {} {} {:.2g}", count, noun,
                       met ? fmt::format("{} to", held) : "missed by up to", error);
}

Lines exactness(const FitReport& r) {
    Lines lines;
    if (r.interpolated > 0)
        lines.emplace_back("exact", held_words(r.interpolated, "sample", "samples", "hit", r,
                                               "exact samples", r.constraint_error));
    if (r.tangents > 0)
        lines.emplace_back("exact", held_words(r.tangents, "tangent", "tangents", "held", r,
                                               "tangents", r.tangent_error));
    if (r.boundaries > 0)
        lines.emplace_back("exact", held_words(r.boundaries, "boundary", "boundaries", "held", r,
                                               "boundaries", r.boundary_error));
    if (r.inflections >= 0)
        lines.emplace_back(
            "shape", r.allowed_inflections >= 0
                         ? fmt::format("{} inflections in the control polygon, {} allowed",
                                       r.inflections, r.allowed_inflections)
                         : fmt::format("{} inflections in the control polygon", r.inflections));
    if (r.held_back > 0)
        lines.emplace_back("shape", fmt::format("it locked the iteration, which was to move a "
                                                "control point by {:.3g} more",
                                                r.held_back));
    return lines;
}

std::string words_of(const Goal& goal) {
    return fmt::format("{}: stated {:.6g}, {}", goal.name, goal.stated,
                       std::isfinite(goal.reached) ? fmt::format("reached {:.6g}", goal.reached)
                                                   : "turned round");
}

/// Stated goals that were not reached, but for the tolerance, whose verdict says so.
Lines missed_goals(const FitReport& r) {
    Lines lines;
    for (const Goal& goal : r.goals)
        if (!goal.met && goal.name != "tolerance") lines.emplace_back("missed", words_of(goal));
    return lines;
}

} // namespace

std::string missed_words(const FitReport& report) {
    std::string words;
    for (const Goal& goal : report.goals)
        if (!goal.met)
            words += (words.empty() ? "missed: " : "; ") +
                     (goal.name == "tolerance" ? "tolerance " + tolerance_words(report)
                                               : words_of(goal));
    return words;
}

std::vector<std::pair<std::string, std::string>> FitReport::lines() const {
    Lines result;
    for (const auto part : {closeness, course, noise, exactness, missed_goals})
        std::ranges::move(part(*this), std::back_inserter(result));
    std::string times;
    for (const auto& [stage, time] : seconds)
        times += fmt::format("{}{} {:.2g}", times.empty() ? "" : ", ", stage, time);
    result.emplace_back("seconds", fmt::format("{:.3g} ({})", total_seconds(), times));
    if (bytes_read > 0) {
        const std::string read = fmt::format("{:.4g} MB", static_cast<double>(bytes_read) / 1e6);
        result.emplace_back("read",
                            passes > 0 ? fmt::format("{} in {} passes", read, passes) : read);
    }
    for (const std::string& note : notes) result.emplace_back("note", note);
    return result;
}

} // namespace batten
