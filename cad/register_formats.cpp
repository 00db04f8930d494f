#include "message.hpp"
#include "process.hpp"

#include <batten/cad/cad.hpp>
#include <batten/core/core.hpp>
#include <batten/io/spline_file.hpp>

#include <fmt/format.h>

namespace batten::cad {

namespace {

constexpr const char* program_name = "batten-cad";

/// What was said last; the registered formats look here.
Options& options() {
    static Options given;
    return given;
}

/// Where the program may be: where it was installed, beside the calling program, in ../libexec from
/// there.
std::vector<std::filesystem::path> places() {
    std::vector<std::filesystem::path> result;
    if (!options().program.empty()) result.push_back(options().program);
    std::error_code unknown;
    const std::filesystem::path caller = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (unknown) return result;
    result.push_back(caller.parent_path() / program_name);
    result.push_back(caller.parent_path().parent_path() / BATTEN_LIBEXECDIR / program_name);
    return result;
}

std::filesystem::path located_program() {
    std::error_code ignored;
    std::string looked;
    for (const std::filesystem::path& place : places()) {
        if (std::filesystem::is_regular_file(place, ignored)) return place;
        looked += fmt::format("{}{}", looked.empty() ? "" : ", no ", place.string());
    }
    throw InvalidInput(fmt::format("STEP and IGES need the program {}, which was not built (cmake "
                                   "-DBATTEN_CAD=ON) or not installed: there is no {}",
                                   program_name, looked));
}

/// The answer to a request, taken apart as far as the outcome.
Unpacker answer(Packer request) {
    Unpacker reply(answer_of(located_program(), std::move(request).finish(), options().cancelled));
    const auto outcome = static_cast<Outcome>(reply.take_number());
    if (outcome == Outcome::done) return reply;
    const std::string words = reply.take_text();
    if (outcome == Outcome::invalid_input) throw InvalidInput(words);
    if (outcome == Outcome::file_error) throw FileError(words);
    throw Failed(words);
}

std::string written(Task task, const Scene& scene) {
    Packer request;
    request.put(static_cast<std::int64_t>(task));
    for (const std::string& text : {scene.title, scene.unit, scene.date}) request.put(text);
    const std::vector<const Spline*> splines = scene.splines();
    request.put(static_cast<std::int64_t>(splines.size()));
    for (const Spline* spline : splines) request.put(*spline);
    try {
        return answer(std::move(request)).take_text();
    } catch (const Failed& failure) {
        throw SolverError(fmt::format("Open CASCADE failed while writing ({})", failure.what()));
    }
}

SplineFile parsed(Task task, const std::filesystem::path& path, const std::string& content) {
    Packer request;
    request.put(static_cast<std::int64_t>(task));
    request.put(path.string());
    request.put(content);
    try {
        Unpacker reply = answer(std::move(request));
        SplineFile file;
        for (std::int64_t count = reply.take_number(); count > 0; --count)
            file.splines.push_back(reply.take_spline());
        for (std::int64_t count = reply.take_number(); count > 0; --count)
            file.notes.push_back(reply.take_text());
        return file;
    } catch (const Failed& failure) {
        throw FileError(fmt::format("{}: Open CASCADE failed while reading it ({})", path.string(),
                                    failure.what()));
    }
}

void add_format(std::string extension, std::string description, Task write, Task read) {
    register_format({std::move(extension), std::move(description),
                     [write](const Scene& scene) { return written(write, scene); },
                     [read](const std::filesystem::path& path, const std::string& content) {
                         return parsed(read, path, content);
                     },
                     true, cad_limits, SceneDetail::unit_and_date});
}

bool add_formats() {
    for (const char* extension : {".step", ".stp"})
        add_format(extension, "STEP (AP214) edges and faces", Task::write_step, Task::read_step);
    for (const char* extension : {".igs", ".iges"})
        add_format(extension, "IGES 5.3 curves and surfaces", Task::write_iges, Task::read_iges);
    return true;
}

} // namespace

void register_formats(Options given) {
    options() = std::move(given);
    [[maybe_unused]] static const bool added = add_formats();
}

} // namespace batten::cad
