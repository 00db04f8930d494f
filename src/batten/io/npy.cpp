#include <batten/io/point_formats.hpp>

#include <bit>
#include <charconv>
#include <cstdint>
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

Header parse_header(const std::filesystem::path& path, std::string_view content) {
    if (content.size() < 10 || !content.starts_with("\x93NUMPY"))
        fail(path, "not a .npy file: its first bytes are not \\x93NUMPY");
    const auto byte = [&](std::size_t k) {
        return static_cast<std::size_t>(static_cast<unsigned char>(content[k]));
    };
    const std::size_t version = byte(6);
    if (version < 1 || version > 3)
        fail(path, fmt::format(".npy version {} is outside 1 to 3", version));
    const std::size_t begin = version == 1 ? 10 : 12;
    if (content.size() < begin) fail(path, "the file ends inside the header");
    const std::size_t length = version == 1
                                   ? byte(8) | byte(9) << 8U
                                   : byte(8) | byte(9) << 8U | byte(10) << 16U | byte(11) << 24U;
    if (content.size() < begin + length)
        fail(path, fmt::format("the file ends inside the header: {} bytes stated, {} there", length,
                               content.size() - begin));
    const std::string_view dictionary = content.substr(begin, length);
    const std::string_view type = value_of(path, dictionary, "descr");
    if (type.size() < 5 || type[0] != '\'' || type.find('\'', 1) != 4)
        fail(path, "the numbers' type is not a plain number (float or integer is needed)");
    Header header{type[1],
                  type[2],
                  static_cast<std::size_t>(type[3] - '0'),
                  value_of(path, dictionary, "fortran_order").starts_with("True"),
                  parse_shape(path, value_of(path, dictionary, "shape")),
                  begin + length};
    const bool known =
        (header.kind == 'f' && (header.width == 4 || header.width == 8)) ||
        ((header.kind == 'i' || header.kind == 'u') &&
         (header.width == 1 || header.width == 2 || header.width == 4 || header.width == 8));
    if (!known)
        fail(path, fmt::format("numbers of type '{}' are not read (float or integer is needed)",
                               type.substr(1, 3)));
    return header;
}

template <class T>
double converted(std::uint64_t bits) {
    if constexpr (sizeof(T) == 8)
        return static_cast<double>(std::bit_cast<T>(bits));
    else if constexpr (sizeof(T) == 4)
        return static_cast<double>(std::bit_cast<T>(static_cast<std::uint32_t>(bits)));
    else if constexpr (sizeof(T) == 2)
        return static_cast<double>(std::bit_cast<T>(static_cast<std::uint16_t>(bits)));
    else
        return static_cast<double>(std::bit_cast<T>(static_cast<std::uint8_t>(bits)));
}

double number(const Header& header, const char* at) {
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < header.width; ++k) {
        const std::size_t place = header.order == '>' ? header.width - 1 - k : k;
        bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(at[place])) << (8 * k);
    }
    if (header.kind == 'f')
        return header.width == 8 ? converted<double>(bits) : converted<float>(bits);
    const bool is_signed = header.kind == 'i';
    switch (header.width) {
    case 1:
        return is_signed ? converted<std::int8_t>(bits) : converted<std::uint8_t>(bits);
    case 2:
        return is_signed ? converted<std::int16_t>(bits) : converted<std::uint16_t>(bits);
    case 4:
        return is_signed ? converted<std::int32_t>(bits) : converted<std::uint32_t>(bits);
    default:
        return is_signed ? converted<std::int64_t>(bits) : converted<std::uint64_t>(bits);
    }
}

/// Position in the file of element `k` of the row-major array.
std::size_t place(const Header& header, std::size_t k) {
    if (!header.fortran) return k;
    std::size_t result = 0;
    std::size_t stride = 1;
    for (Index n : header.shape) stride *= static_cast<std::size_t>(n);
    for (std::size_t a = header.shape.size(); a-- > 0;) {
        const auto n = static_cast<std::size_t>(header.shape[a]);
        stride /= n;
        result += (k % n) * stride;
        k /= n;
    }
    return result;
}

} // namespace

NumberArray parse_npy(const std::filesystem::path& path, std::string_view content) {
    const Header header = parse_header(path, content);
    const std::size_t available = (content.size() - header.data_begin) / header.width;
    std::size_t count = 1;
    for (Index n : header.shape) {
        // compare before multiplying: a forged shape must neither overflow nor allocate
        if (n > 0 && count > available / static_cast<std::size_t>(n))
            fail(path, fmt::format("shape {} needs more numbers than the {} in the file",
                                   fmt::join(header.shape, "x"), available));
        count *= static_cast<std::size_t>(n);
    }
    if (count > available) // a single number, of shape ()
        fail(path, fmt::format("a number is stated, {} bytes are there",
                               content.size() - header.data_begin));
    NumberArray result{std::vector<double>(count), header.shape, {}};
    if (count == 0) return result;
    const char* data = content.data() + header.data_begin;
    const bool native =
        header.kind == 'f' && header.width == 8 && header.order != '>' && !header.fortran;
    if (native && std::endian::native == std::endian::little) {
        std::memcpy(result.values.data(), data, count * sizeof(double));
        return result;
    }
    for (std::size_t k = 0; k < count; ++k)
        result.values[k] = number(header, data + place(header, k) * header.width);
    return result;
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
