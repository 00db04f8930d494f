#include "spline_input.hpp"

#include "parse.hpp"

#include <batten/io/spline_file.hpp>

#include <cstdio>
#include <fmt/format.h>

namespace batten::command {

void add_entity(CLI::App& app, Index& entity) {
    app.add_option("--entity", entity, "Number of the spline in a file that holds several, from 1")
        ->check(positive());
}

void add_spline_input(CLI::App& app, SplineInput& input) {
    app.add_option("SPLINE", input.path, "Spline .json .step .iges")->required();
    add_entity(app, input.entity);
}

std::vector<Spline> read_all(const SplineInput& input) {
    SplineFile file = read_splines(input.path);
    for (const std::string& note : file.notes)
        std::fputs(fmt::format("batten: {}: {}\n", input.path, note).c_str(), stderr);
    if (input.entity == 0) return std::move(file.splines);
    return {one_of(std::move(file), input.path, input.entity)};
}

Spline read(const SplineInput& input) {
    std::vector<Spline> splines = read_all(input);
    return one_of({std::move(splines)}, input.path, 0);
}

} // namespace batten::command
