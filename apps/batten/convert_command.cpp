#include "commands.hpp"
#include "export_flags.hpp"
#include "parse.hpp"
#include "spline_input.hpp"

#include <batten/io/output_set.hpp>
#include <batten/io/spline_file.hpp>

#include <memory>
#include <utility>

namespace batten::command {

namespace {

constexpr std::string_view number_mark = "%d"; // in a file's name: a file for each spline

struct Flags {
    std::vector<std::string> splines;
    std::vector<std::string> outputs;
    Index entity = 0;
    ExportFlags exported;
};

/// The names of as many files as there are splines, or the name itself.
std::vector<std::string> names_of(const std::string& output, std::size_t splines) {
    if (output.find(number_mark) == std::string::npos) return {output};
    std::vector<std::string> names;
    for (std::size_t k = 1; k <= splines; ++k) {
        std::string name = output;
        for (std::size_t at = 0; (at = name.find(number_mark)) != std::string::npos;)
            name.replace(at, number_mark.size(), std::to_string(k));
        names.push_back(std::move(name));
    }
    return names;
}

/// The splines from `first` on, so many.
Scene scene_of(const std::vector<Spline>& splines, std::size_t first, std::size_t count,
               const Flags& flags) {
    Scene scene{.spline = splines[first],
                .title = std::filesystem::path(flags.splines.front()).stem().string()};
    for (std::size_t k = first + 1; k < first + count; ++k) scene.more.push_back(&splines[k]);
    apply(flags.exported, scene);
    return scene;
}

void convert(const Flags& flags, const CLI::App& app) {
    std::vector<FileUse> inputs;
    for (const std::string& path : flags.splines) inputs.push_back({path, "a spline"});
    std::vector<FileUse> written;
    for (const std::string& output : flags.outputs) {
        check_output(output);
        written.push_back({output, "--output"});
    }
    check_outputs(written, inputs);
    check(flags.exported, app, flags.outputs);
    std::vector<Spline> splines;
    for (const std::string& path : flags.splines)
        for (Spline& spline : read_all({path, flags.entity})) splines.push_back(std::move(spline));
    std::vector<std::pair<std::string, Scene>> files;
    for (const std::string& output : flags.outputs) {
        const bool apart = output.find(number_mark) != std::string::npos;
        const std::vector<std::string> names = names_of(output, splines.size());
        for (std::size_t k = 0; k < names.size(); ++k)
            files.emplace_back(names[k], apart ? scene_of(splines, k, 1, flags)
                                               : scene_of(splines, 0, splines.size(), flags));
    }
    written.clear();
    for (const auto& [name, scene] : files) written.push_back({name, "--output"});
    check_outputs(written, inputs);
    OutputSet set;
    for (const auto& [name, scene] : files) set.add(name, spline_content(name, scene));
    set.put_in_place();
    for (const auto& [name, scene] : files) print_notes({name}, scene);
}

} // namespace

void add_convert(CLI::App& app) {
    CLI::App* sub = app.add_subcommand("convert", "Splines in another format");
    auto flags = std::make_shared<Flags>();
    sub->add_option("SPLINE", flags->splines,
                    "Splines: .json .step .iges; several where the format holds them")
        ->required();
    add_entity(*sub, flags->entity);
    sub->add_option("--output,-o", flags->outputs,
                    "File whose extension names the format, %d in it: one for each spline, "
                    "numbered; may be repeated")
        ->required()
        ->group("Output");
    add_export_flags(*sub, flags->exported);
    one_value_each(*sub);
    sub->footer("Examples:\n  batten convert part.json -o part.step --unit m\n"
                "  batten convert upper.json lower.json -o wing.igs\n"
                "  batten convert wing.igs -o wing-%d.json");
    sub->callback([flags, sub] { convert(*flags, *sub); });
}

} // namespace batten::command
