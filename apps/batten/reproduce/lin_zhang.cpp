#include "papers.hpp"

#include <batten/samples/generate.hpp>

#include <fmt/format.h>

namespace batten::command {

namespace {

FitOptions letter_options(double eta) {
    FitOptions options;
    options.method = {.name = "epia", .settings = {{"eta", eta}}};
    options.stop = {.max_iterations = 300, .relative_gradient = 0, .deviation = 0.0035};
    return options;
}

struct Printed {
    double eta;
    const char *start, *end, *iterations, *deviation;
};

Table table_1(const Printed& printed, Workshop& workshop) {
    const Samples letter = generate("letter");
    FitOptions options = letter_options(printed.eta);
    const FitResult result =
        drawn_fit(letter, options, workshop, fmt::format("epia_letter_{}", printed.eta), {0, 15});
    options.stop.max_iterations = 0;
    const Index first = fit(letter, options).report.control_shape[0];
    const FitReport& report = result.report;
    return {fmt::format("Table 1, eta {}", printed.eta),
            {{"control points at the start", printed.start, static_cast<double>(first)},
             {"control points at e_d <= 0.0035", printed.end,
              static_cast<double>(report.control_shape[0])},
             {"iterations", printed.iterations, static_cast<double>(report.iterations)},
             {"e_d", printed.deviation, report.deviation.maximum}},
            Data::stand_in,
            "a letter G of 269 points of the same size"};
}

} // namespace

std::vector<Table> lin_zhang(Workshop& workshop) {
    FitOptions options;
    options.method.name = "epia";
    options.stop = {.max_iterations = 100, .relative_gradient = 0, .deviation = 0.01};
    const auto history =
        drawn_fit(generate("peaks", {121, 161}), options, workshop, "epia_peaks", {})
            .report.history;
    return {table_1({0.6, "37", "66", "70", "0.003501"}, workshop),
            table_1({0.9, "83", "92", "40", "0.003494"}, workshop),
            {"Table 2, patch",
             {{"error at the start over that after 100", "20.71",
               history.front().max_deviation / history.back().max_deviation}},
             Data::stand_in,
             "peaks, 121 x 161 samples"}};
}

} // namespace batten::command
