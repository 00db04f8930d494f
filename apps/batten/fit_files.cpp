#include "fit_files.hpp"

#include "parse.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/output_place.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/problem/problem.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <unistd.h>

namespace batten::command {

namespace {

std::vector<FileUse> outputs_of(const FitFlags& flags) {
    std::vector<FileUse> outputs;
    for (const std::string& path : flags.outputs) outputs.push_back({path, "--output"});
    if (!flags.report.empty()) outputs.push_back({flags.report, "--report"});
    if (!flags.summary.empty()) outputs.push_back({flags.summary, "--summary"});
    return outputs;
}

/// Every file that some flag reads; what is a word or a list of numbers to a flag is none.
std::vector<FileUse> inputs_of(const FitFlags& flags) {
    std::vector<FileUse> inputs{{flags.points, "the points"}};
    const auto add = [&](const char* flag, const std::string& text,
                         std::initializer_list<std::string_view> words = {}) {
        if (!is_list(text) && std::ranges::count(words, std::string_view(text)) == 0)
            inputs.push_back({text, flag});
    };
    add("--weights", flags.weights);
    add("--tolerances", flags.tolerances);
    for (const std::string& path : flags.parameters) add("--parameters", path);
    add("--knots", flags.knots, {"data", "uniform"});
    add("--initial", flags.initial, {"data", "zero"});
    add("--before", flags.before);
    add("--corners", flags.corners, {"auto", "none"});
    add("--interpolate", flags.interpolate, {"ends"});
    add("--moving", flags.moving);
    add("--tangents", flags.tangents);
    add("--derivatives", flags.derivatives);
    for (const std::string& text : flags.boundaries) // u0=FILE
        add("--boundary", text.substr(std::min(text.size(), text.find('=') + 1)));
    return inputs;
}

} // namespace

void check_files(const FitFlags& flags) {
    for (const std::string& output : flags.outputs) check_output(output);
    if (!flags.report.empty() && extension(flags.report) != ".html" && !is_stream(flags.report))
        throw InvalidInput(fmt::format("--report {}: a page .html is written", flags.report));
    check_outputs(outputs_of(flags), inputs_of(flags));
}

void check_holds(const FitFlags& flags, const Samples& samples, const FitOptions& options) {
    const Index axes = axis_count(samples, options.shape);
    for (const std::string& output : flags.outputs)
        batten::check_holds(output, axes, samples.dim());
    if (!flags.report.empty()) check(page_limits, axes, samples.dim());
}

bool writes_standard_output(const FitFlags& flags) {
    return take_standard_output(outputs_of(flags));
}

bool take_standard_output(std::span<const FileUse> outputs) {
    return std::ranges::any_of(outputs, [](const FileUse& output) {
        return output_place(output.path).descriptor == STDOUT_FILENO;
    });
}

} // namespace batten::command
