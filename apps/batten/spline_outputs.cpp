#include "spline_outputs.hpp"

#include "fit_files.hpp"

#include <batten/io/output_set.hpp>
#include <batten/io/spline_file.hpp>

#include <cstdio>

namespace batten::command {

void add_spline_outputs(CLI::App& app, SplineOutputs& outputs) {
    app.add_option("--output,-o", outputs.files,
                   "File whose extension names the format; may be repeated")
        ->required()
        ->group("Output");
    app.add_option("--summary", outputs.summary, "The account as JSON")->group("Output");
    app.add_flag("--quiet,-q", outputs.quiet, "Print nothing")->group("Output");
    add_export_flags(app, outputs.exported);
}

std::vector<FileUse> checked(const SplineOutputs& outputs, const CLI::App& app,
                             const std::vector<FileUse>& inputs) {
    std::vector<FileUse> written;
    for (const std::string& file : outputs.files) {
        check_output(file);
        written.push_back({file, "--output"});
    }
    if (!outputs.summary.empty()) written.push_back({outputs.summary, "--summary"});
    check_outputs(written, inputs);
    check(outputs.exported, app, outputs.files);
    return written;
}

void write(const SplineOutputs& outputs, const std::vector<FileUse>& written, Scene scene,
           const std::string& json, const std::string& words) {
    apply(outputs.exported, scene);
    OutputSet set;
    for (const std::string& file : outputs.files) set.add(file, spline_content(file, scene));
    if (!outputs.summary.empty()) set.add(outputs.summary, json);
    set.put_in_place();
    if (outputs.quiet) return;
    print_notes(outputs.files, scene);
    std::fputs(words.c_str(), take_standard_output(written) ? stderr : stdout);
}

} // namespace batten::command
