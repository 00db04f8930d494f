#include "commands.hpp"
#include "parse.hpp"

#include <batten/drivers/table.hpp>
#include <batten/io/output_place.hpp>
#include <batten/io/points_file.hpp>
#include <batten/samples/generate.hpp>

#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace batten::command {

namespace {

void print_settings(std::span<const MethodSetting> settings) {
    for (const MethodSetting& s : settings)
        fmt::print("                  --set {}=...  {}, {} (default {}){}\n", s.name, s.meaning,
                   s.range.words(s.name), s.default_words(),
                   s.source.empty() ? "" : fmt::format(" [{}]", s.source));
}

} // namespace

void add_generate(CLI::App& app) {
    struct Flags {
        std::string name, size, output = "-";
    };
    CLI::App* sub = app.add_subcommand("generate", "Built-in data sets");
    auto flags = std::make_shared<Flags>();
    std::string list = "Data sets:\n";
    for (const Generator& g : generators())
        list +=
            fmt::format("  {:<12}{} ({})\n", g.name, g.description, fmt::join(g.default_size, "x"));
    sub->add_option("NAME", flags->name, "One of the data sets below")->required();
    sub->add_option("--samples", flags->size, "Samples per axis: 201 or 121x121");
    sub->add_option("--output,-o", flags->output,
                    "Points: .csv .txt .xyz .dat .npy (which keeps a grid's shape)")
        ->capture_default_str();
    sub->footer(list + "Example:\n  batten generate peaks -o peaks.npy");
    sub->callback([flags] {
        check_outputs(std::array{FileUse{flags->output, "--output"}}, {});
        std::vector<Index> size;
        if (!flags->size.empty()) size = parse_shape("--samples", flags->size);
        constexpr Index dim = 3; // of none more
        check_room(flags->output, size, dim);
        const Samples samples = generate(flags->name, size);
        write_points(flags->output, samples.points, samples.grid);
    });
}

void add_methods(CLI::App& app) {
    CLI::App* sub = app.add_subcommand("methods", "The methods and their settings");
    auto table = std::make_shared<bool>(false);
    sub->add_flag("--table", *table, "What each can be asked for, as a table");
    sub->footer("Examples:\n  batten methods\n  batten methods --table");
    sub->callback([table] {
        if (*table) return fmt::print("{}", driver_table());
        fmt::print("{:<18}the fastest that takes what is asked\n", "auto");
        for (const Driver& entry : drivers()) {
            fmt::print("{:<18}{}{}\n", entry.name, entry.description,
                       entry.source.empty() ? "" : fmt::format(" [{}]", entry.source));
            print_settings(entry.settings);
        }
        fmt::print("every iteration with --preserve\n");
        print_settings(shape_settings());
    });
}

} // namespace batten::command
