#include <batten/io/buffered_bytes.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/record_reader.hpp>

#include <fmt/format.h>

namespace batten {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw FileError(fmt::format("{}: {}", path.string(), what));
}

/// LAS 1.4 has a second count, of 64 bits; 0 where it is left out.
std::uint64_t long_count(BufferedBytes& bytes) {
    bytes.seek(247, "the header");
    return bytes.read<std::uint64_t>("the number of points");
}

RecordLayout point_records(const std::filesystem::path& path, BufferedBytes& bytes) {
    if (!bytes.starts_with("LASF")) fail(path, "not a LAS file: its first bytes are not LASF");
    bytes.seek(24, "the header's version");
    const int major = bytes.read<std::uint8_t>("the header's version");
    const int minor = bytes.read<std::uint8_t>("the header's version");
    if (major != 1 || minor < 2 || minor > 4)
        fail(path, fmt::format("LAS version {}.{} is outside 1.2 to 1.4", major, minor));
    RecordLayout layout;
    bytes.seek(96, "the header");
    layout.begin = bytes.read<std::uint32_t>("the offset to the points");
    bytes.seek(104, "the header");
    const int format = bytes.read<std::uint8_t>("the point format");
    if ((format & 0x80) != 0) fail(path, "the points are compressed (LAZ); only plain LAS is read");
    layout.length = bytes.read<std::uint16_t>("the record's length");
    if (layout.length < 20)
        fail(path, fmt::format("point records of {} bytes; at least 20 are needed", layout.length));
    layout.count = bytes.read<std::uint32_t>("the number of points");
    for (std::size_t d = 0; d < 3; ++d)
        layout.fields.push_back({.place = 4 * d, .kind = NumberKind::int32, .scaled = true});
    bytes.seek(131, "the header");
    for (RecordField& field : layout.fields) field.scale = bytes.read<double>("the scale");
    for (RecordField& field : layout.fields) field.offset = bytes.read<double>("the offset");
    if (minor == 4)
        if (const std::uint64_t count = long_count(bytes); count > 0) layout.count = count;
    bytes.seek(layout.begin, "the first point");
    // compare before multiplying: a forged count must neither overflow nor allocate
    if (layout.count > bytes.left() / layout.length)
        fail(path, fmt::format("{} points of {} bytes are stated, {} bytes are there after byte {}",
                               layout.count, layout.length, bytes.left(), layout.begin));
    return layout;
}

} // namespace

std::unique_ptr<NumberReader> open_las(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> source) {
    BufferedBytes bytes(path, sized_and_not_empty(path, std::move(source)));
    RecordLayout layout = point_records(path, bytes);
    const auto count = static_cast<Index>(layout.count);
    return std::make_unique<RecordReader>(path.string(), bytes.release(), std::move(layout),
                                          std::vector<Index>{count, 3});
}

} // namespace batten
