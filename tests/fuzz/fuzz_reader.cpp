// libFuzzer target of one reader, named by BATTEN_READER: whatever the bytes, it returns numbers or
// throws one of the library's errors, and allocates no more than the bytes can hold.
#include <batten/core/core.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/spline_file.hpp>

#include <cstdint>

namespace {

using namespace batten;

[[maybe_unused]] void text(std::string_view content) {
    parse_text("fuzz.csv", content);
}
[[maybe_unused]] void airfoil(std::string_view content) {
    parse_text("fuzz.dat", content);
}
[[maybe_unused]] void npy(std::string_view content) {
    parse_npy("fuzz.npy", content);
}
[[maybe_unused]] void ply(std::string_view content) {
    parse_ply("fuzz.ply", content);
}
[[maybe_unused]] void obj(std::string_view content) {
    parse_obj("fuzz.obj", content);
}
[[maybe_unused]] void stl(std::string_view content) {
    parse_stl("fuzz.stl", content);
}
[[maybe_unused]] void las(std::string_view content) {
    parse_las("fuzz.las", content);
}
[[maybe_unused]] void json(std::string_view content) {
    parse_spline_json("fuzz.json", std::string(content));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        BATTEN_READER({reinterpret_cast<const char*>(data), size});
    } catch (const InvalidInput&) {
    } catch (const FileError&) {
    }
    return 0;
}
