#include <batten/io/byte_reader.hpp>
#include <batten/io/point_formats.hpp>

#include <array>

namespace batten {

NumberArray parse_las(const std::filesystem::path& path, std::string_view content) {
    const auto fail = [&](const std::string& what) {
        throw FileError(fmt::format("{}: {}", path.string(), what));
    };
    if (!content.starts_with("LASF")) fail("not a LAS file: its first bytes are not LASF");
    ByteReader bytes(path, content);
    bytes.seek(24, "the header's version");
    const int major = bytes.read<std::uint8_t>("the header's version");
    const int minor = bytes.read<std::uint8_t>("the header's version");
    if (major != 1 || minor < 2 || minor > 4)
        fail(fmt::format("LAS version {}.{} is outside 1.2 to 1.4", major, minor));
    bytes.seek(96, "the header");
    const auto begin = bytes.read<std::uint32_t>("the offset to the points");
    bytes.seek(104, "the header");
    const int format = bytes.read<std::uint8_t>("the point format");
    if ((format & 0x80) != 0) fail("the points are compressed (LAZ); only plain LAS is read");
    const auto length = bytes.read<std::uint16_t>("the record's length");
    if (length < 20) fail(fmt::format("point records of {} bytes; at least 20 are needed", length));
    std::uint64_t count = bytes.read<std::uint32_t>("the number of points");
    std::array<double, 3> scale{};
    std::array<double, 3> offset{};
    bytes.seek(131, "the header");
    for (double& x : scale) x = bytes.read<double>("the scale");
    for (double& x : offset) x = bytes.read<double>("the offset");
    if (minor == 4) {
        bytes.seek(247, "the header");
        if (const auto long_count = bytes.read<std::uint64_t>("the number of points");
            long_count > 0)
            count = long_count;
    }
    bytes.seek(begin, "the first point");
    // compare before multiplying: a forged count must neither overflow nor allocate
    if (count > bytes.left() / length)
        fail(fmt::format("{} points of {} bytes are stated, {} bytes are there after byte {}",
                         count, length, bytes.left(), begin));
    NumberArray result;
    result.values.reserve(3 * static_cast<std::size_t>(count));
    for (std::uint64_t i = 0; i < count; ++i) {
        bytes.seek(begin + static_cast<std::size_t>(i) * length, "a point");
        for (std::size_t d = 0; d < 3; ++d)
            result.values.push_back(bytes.read<std::int32_t>("a point") * scale[d] + offset[d]);
    }
    result.shape = {static_cast<Index>(count), 3};
    return result;
}

} // namespace batten
