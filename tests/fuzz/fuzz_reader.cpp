// libFuzzer target of one reader, named by BATTEN_READER: whatever the bytes, it returns numbers or
// throws one of the library's errors, and allocates no more than the bytes can hold.
#include <batten/core/core.hpp>
#include <batten/io/checksum.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/system_file.hpp>
#include <batten/io/text_reader.hpp>

#include <cstdint>
#include <string>

namespace {

using namespace batten;

/// All numbers at once, and again in parts that end somewhere.
void read(PointFormat::Open open, PointFormat::Open open_for_passes, const char* name,
          std::string_view content) {
    open(name, bytes_in_memory(content))->all();
    const auto reader = open_for_passes(name, bytes_in_memory(content));
    double part[7];
    while (reader->read(part) > 0) continue;
    reader->rewind();
    reader->read(part);
}

[[maybe_unused]] void text(std::string_view content) {
    read(open_text, open_text_for_passes, "fuzz.csv", content);
}
[[maybe_unused]] void airfoil(std::string_view content) {
    read(open_text, open_text_for_passes, "fuzz.dat", content);
}
/// Parts so small that lines and blocks end everywhere.
[[maybe_unused]] void parts(std::string_view content) {
    TextReader("fuzz.csv", bytes_in_memory(content), {.window = 16, .block = 1}).all();
    TextReader("fuzz.dat", bytes_in_memory(content), {.window = 16, .block = 1}).all();
}
[[maybe_unused]] void gz(std::string_view content) {
    const auto bytes = uncompressed("fuzz.csv.gz", bytes_in_memory(content));
    char part[4096];
    while (bytes->read(part) > 0) continue;
}
[[maybe_unused]] void npy(std::string_view content) {
    read(open_npy, open_npy, "fuzz.npy", content);
}
[[maybe_unused]] void ply(std::string_view content) {
    read(open_ply, open_ply, "fuzz.ply", content);
}
[[maybe_unused]] void obj(std::string_view content) {
    read(open_obj, open_obj, "fuzz.obj", content);
}
[[maybe_unused]] void stl(std::string_view content) {
    read(open_stl, open_stl, "fuzz.stl", content);
}
[[maybe_unused]] void las(std::string_view content) {
    read(open_las, open_las, "fuzz.las", content);
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
