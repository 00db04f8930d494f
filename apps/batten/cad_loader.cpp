#include "cad_loader.hpp"

#include "../../cad/cad_formats.hpp"

#include <array>
#include <dlfcn.h>
#include <fmt/format.h>

namespace batten::command {

namespace {

constexpr const char* module_file = "libbatten_cad.so";

/// The module: beside the command, or where it is installed.
const cad::Module& module() {
    static const cad::Module* const loaded = []() -> const cad::Module* {
        std::error_code error;
        const std::filesystem::path here =
            std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
        for (const std::filesystem::path& folder : {here, here / ".." / BATTEN_LIBDIR / "batten"}) {
            void* library = dlopen((folder / module_file).c_str(), RTLD_NOW | RTLD_LOCAL);
            if (library == nullptr) continue;
            void* symbol = dlsym(library, "batten_cad_module");
            if (symbol != nullptr) return reinterpret_cast<const cad::Module* (*)()>(symbol)();
        }
        return nullptr;
    }();
    if (loaded == nullptr)
        throw InvalidInput(fmt::format("STEP and IGES need {}, which was not built (cmake "
                                       "-DBATTEN_CAD=ON) or not installed",
                                       module_file));
    return *loaded;
}

} // namespace

void register_cad_formats() {
    for (const char* extension : {".step", ".stp"})
        register_format({extension, "STEP (AP214) edges and faces",
                         [](const Scene& scene) { return module().step_text(scene); },
                         [](const std::filesystem::path& path, const std::string& content) {
                             return module().parse_step(path, content);
                         },
                         true});
    for (const char* extension : {".igs", ".iges"})
        register_format({extension, "IGES 5.3 curves and surfaces",
                         [](const Scene& scene) { return module().iges_text(scene); },
                         [](const std::filesystem::path& path, const std::string& content) {
                             return module().parse_iges(path, content);
                         },
                         true});
}

} // namespace batten::command
