#include <batten/core/counts.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/record_reader.hpp>

#include <bit>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

struct Header {
    char order; // '<', '>' or '|'
    char kind;  // f, i, u
    std::size_t width;
    bool fortran;
    std::vector<Index> shape;
    std::size_t data_begin;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw FileError(fmt::format("{}: {}", path.string(), what));
}

/// The text after `'key':` in the header's dictionary.
std::string_view value_of(const std::filesystem::path& path, std::string_view dictionary,
                          std::string_view key) {
    const std::size_t at = dictionary.find(fmt::format("'{}':", key));
    if (at == std::string_view::npos) fail(path, fmt::format("the header lacks '{}'", key));
    std::string_view rest = dictionary.substr(at + key.size() + 3);
    while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
    return rest;
}

std::vector<Index> parse_shape(const std::filesystem::path& path, std::string_view text) {
    std::vector<Index> shape;
    const std::size_t end = text.find(')');
    if (text.empty() || text.front() != '(' || end == std::string_view::npos)
        fail(path, "the header's shape is not a tuple");
    text = text.substr(1, end - 1);
    while (!text.empty()) {
        if (text.front() == ' ' || text.front() == ',') {
            text.remove_prefix(1);
            continue;
        }
        Index n = 0;
        const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), n);
        if (error != std::errc() || n < 0)
            fail(path, "the header's shape is not a tuple of counts");
        shape.push_back(n);
        text.remove_prefix(static_cast<std::size_t>(next - text.data()));
    }
    return shape;
}

/// The bytes before the numbers, all of them.
std::string head_of(const std::filesystem::path& path, ByteSource& bytes) {
    std::string head(12, '\0');
    head.resize(bytes.read(head));
    if (head.size() < 10 || !head.starts_with("\x93NUMPY"))
        fail(path, "not a .npy file: its first bytes are not \\x93NUMPY");
    const auto byte = [&](std::size_t k) {
        return static_cast<std::size_t>(static_cast<unsigned char>(head[k]));
    };
    const std::size_t version = byte(6);
    if (version < 1 || version > 3)
        fail(path, fmt::format(".npy version {} is outside 1 to 3", version));
    const std::size_t begin = version == 1 ? 10 : 12;
    if (head.size() < begin) fail(path, "the file ends inside the header");
    const std::size_t length = version == 1
                                   ? byte(8) | byte(9) << 8U
                                   : byte(8) | byte(9) << 8U | byte(10) << 16U | byte(11) << 24U;
    const auto there = static_cast<std::size_t>(bytes.size());
    if (there < begin + length)
        fail(path, fmt::format("the file ends inside the header: {} bytes stated, {} there", length,
                               there - begin));
    head.resize(begin + length);
    bytes.seek(0);
    bytes.read(head);
    return head;
}

Header parse_header(const std::filesystem::path& path, ByteSource& bytes) {
    const std::string head = head_of(path, bytes);
    const std::string_view type = value_of(path, head, "descr");
    if (type.size() < 5 || type[0] != '\'' || type.find('\'', 1) != 4)
        fail(path, "the numbers' type is not a plain number (float or integer is needed)");
    Header header{type[1],
                  type[2],
                  static_cast<std::size_t>(type[3] - '0'),
                  value_of(path, head, "fortran_order").starts_with("True"),
                  parse_shape(path, value_of(path, head, "shape")),
                  head.size()};
    const bool known =
        (header.kind == 'f' && (header.width == 4 || header.width == 8)) ||
        ((header.kind == 'i' || header.kind == 'u') &&
         (header.width == 1 || header.width == 2 || header.width == 4 || header.width == 8));
    if (!known)
        fail(path, fmt::format("numbers of type '{}' are not read (float or integer is needed)",
                               type.substr(1, 3)));
    return header;
}

/// Which number it is: kinds and widths are checked already.
NumberKind kind_of(const Header& header) {
    if (header.kind == 'f') return header.width == 8 ? NumberKind::float64 : NumberKind::float32;
    const int k = std::countr_zero(header.width); // 1, 2, 4, 8 bytes
    constexpr NumberKind kinds[2][4] = {
        {NumberKind::int8, NumberKind::int16, NumberKind::int32, NumberKind::int64},
        {NumberKind::uint8, NumberKind::uint16, NumberKind::uint32, NumberKind::uint64}};
    return kinds[header.kind == 'u' ? 1 : 0][k];
}

/// Position in the row-major array of element `k` of the file, whose first axis is the fastest.
std::size_t place(const std::vector<Index>& shape, std::size_t k) {
    std::size_t result = 0;
    std::size_t stride = 1;
    for (Index n : shape) stride *= static_cast<std::size_t>(n);
    for (Index length : shape) {
        const auto n = static_cast<std::size_t>(length);
        stride /= n;
        result += (k % n) * stride;
        k /= n;
    }
    return result;
}

/// Puts the numbers of a file in Fortran order in row-major order.
NumberArray reordered(NumberReader& reader) {
    NumberArray result{{}, reader.shape(), reader.notes()};
    const Index count = checked_product(result.shape, reader.path());
    check_memory(count, reader.path());
    result.values.resize(static_cast<std::size_t>(count));
    std::vector<double> part(std::size_t{1} << 16);
    for (std::size_t done = 0; done < result.values.size();) {
        const std::size_t got = reader.read(part);
        for (std::size_t k = 0; k < got; ++k)
            result.values.data()[place(result.shape, done + k)] = part[k];
        done += got;
    }
    return result;
}

/// The numbers that the shape states; FileError unless they are there.
std::size_t count_of(const std::filesystem::path& path, const Header& header,
                     std::size_t bytes_there) {
    const std::size_t available = bytes_there / header.width;
    std::size_t count = 1;
    for (Index n : header.shape) {
        // compare before multiplying: a forged shape must neither overflow nor allocate
        if (n > 0 && count > available / static_cast<std::size_t>(n))
            fail(path, fmt::format("shape {} needs more numbers than the {} in the file",
                                   fmt::join(header.shape, "x"), available));
        count *= static_cast<std::size_t>(n);
    }
    if (count > available) // a single number, of shape ()
        fail(path, fmt::format("a number is stated, {} bytes are there", bytes_there));
    return count;
}

} // namespace

std::unique_ptr<NumberReader> open_npy(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> source) {
    std::unique_ptr<ByteSource> bytes = sized_and_not_empty(path, std::move(source));
    const Header header = parse_header(path, *bytes);
    const std::size_t count =
        count_of(path, header, static_cast<std::size_t>(bytes->size()) - header.data_begin);
    RecordLayout layout{.begin = header.data_begin,
                        .count = count,
                        .length = header.width,
                        .order = header.order == '>' ? std::endian::big : std::endian::little,
                        .fields = {{.place = 0, .kind = kind_of(header)}}};
    auto reader = std::make_unique<RecordReader>(path.string(), std::move(bytes), std::move(layout),
                                                 header.shape);
    if (!header.fortran || header.shape.size() < 2) return reader;
    return std::make_unique<HeldNumbers>(path.string(), reordered(*reader));
}

std::string format_npy(const Points& points, const std::vector<Index>& grid) {
    std::vector<Index> shape = grid.empty() ? std::vector<Index>{points.size()} : grid;
    shape.push_back(points.dim());
    std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}",
                                     fmt::join(shape, ", "));
    while ((header.size() + 11) % 64 != 0) header += ' ';
    header += '\n';
    std::string content = "\x93NUMPY";
    content += {'\1', '\0', static_cast<char>(header.size() & 0xFFU),
                static_cast<char>(header.size() >> 8U)};
    content += header;
    const std::size_t begin = content.size();
    const auto bytes = static_cast<std::size_t>(points.size() * points.dim()) * sizeof(double);
    content.resize(begin + bytes);
    std::memcpy(content.data() + begin, points.data(), bytes);
    return content;
}

} // namespace batten
