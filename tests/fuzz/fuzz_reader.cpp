// libFuzzer target of one reader, named by BATTEN_READER: whatever the bytes, it returns numbers or
// throws one of the library's errors, and allocates no more than the bytes can hold.
#include <batten/core/core.hpp>
#include <batten/io/checksum.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/system_file.hpp>

#include <cstdint>
#include <string>

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
/// As it stands, and with a checksum that matches, so that what comes after it is reached.
[[maybe_unused]] void system(std::string_view content) {
    if (content.size() >= sizeof(std::uint64_t)) {
        std::string whole(content.substr(0, content.size() - sizeof(std::uint64_t)));
        const std::uint64_t sum = checksum(whole);
        for (unsigned k = 0; k < sizeof(sum); ++k)
            whole.push_back(static_cast<char>(sum >> 8 * k & 0xFFU));
        try {
            parse_system("fuzz.sys", whole);
        } catch (const FileError&) {
        }
    }
    parse_system("fuzz.sys", content);
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
