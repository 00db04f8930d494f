#include <batten/io/buffered_bytes.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/record_reader.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/ranges.h>
#include <optional>

namespace batten {

namespace {

struct Property {
    std::string name;
    NumberKind kind;
    std::optional<NumberKind> count; ///< of a list: the kind of its length
};

struct Element {
    std::string name;
    std::uint64_t count;
    std::vector<Property> properties;
};

enum class Encoding { ascii, little, big };

std::endian order_of(Encoding encoding) {
    return encoding == Encoding::big ? std::endian::big : std::endian::little;
}

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::uint64_t end = 0; ///< bytes
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw FileError(fmt::format("{}: {}", path.string(), what));
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    constexpr std::string_view blanks = " \t\r";
    while (true) {
        const std::size_t first = line.find_first_not_of(blanks);
        if (first == std::string_view::npos) return words;
        line.remove_prefix(first);
        const std::size_t length = std::min(line.find_first_of(blanks), line.size());
        words.push_back(line.substr(0, length));
        line.remove_prefix(length);
    }
}

NumberKind kind_of(const std::filesystem::path& path, std::string_view word) {
    struct Name {
        std::string_view old_name, new_name;
        NumberKind kind;
    };
    constexpr Name names[] = {
        {"char", "int8", NumberKind::int8},        {"uchar", "uint8", NumberKind::uint8},
        {"short", "int16", NumberKind::int16},     {"ushort", "uint16", NumberKind::uint16},
        {"int", "int32", NumberKind::int32},       {"uint", "uint32", NumberKind::uint32},
        {"float", "float32", NumberKind::float32}, {"double", "float64", NumberKind::float64}};
    for (const Name& name : names)
        if (word == name.old_name || word == name.new_name) return name.kind;
    fail(path, fmt::format("the header has a property of unknown type '{}'", word));
}

/// `words` of a line of the header; false where they are not understood.
bool take_format(const std::vector<std::string_view>& words, Header& header) {
    if (words[1] == "ascii")
        header.encoding = Encoding::ascii;
    else if (words[1] == "binary_little_endian")
        header.encoding = Encoding::little;
    else if (words[1] == "binary_big_endian")
        header.encoding = Encoding::big;
    else
        return false;
    return true;
}

bool take_element(const std::vector<std::string_view>& words, Header& header) {
    std::uint64_t count = 0;
    const char* end = words[2].data() + words[2].size();
    const auto [next, error] = std::from_chars(words[2].data(), end, count);
    if (error != std::errc() || next != end) return false;
    header.elements.push_back({std::string(words[1]), count, {}});
    return true;
}

bool take_property(const std::filesystem::path& path, const std::vector<std::string_view>& words,
                   Header& header) {
    if (header.elements.empty()) return false;
    std::vector<Property>& properties = header.elements.back().properties;
    if (words.size() == 3)
        properties.push_back({std::string(words[2]), kind_of(path, words[1]), std::nullopt});
    else if (words.size() == 5 && words[1] == "list")
        properties.push_back(
            {std::string(words[4]), kind_of(path, words[3]), kind_of(path, words[2])});
    else
        return false;
    return true;
}

Header parse_header(const std::filesystem::path& path, BufferedBytes& bytes) {
    Header header;
    if (!bytes.starts_with("ply")) fail(path, "not a PLY file: its first line is not 'ply'");
    bool format = false;
    std::string_view line;
    for (std::size_t line_number = 1;; ++line_number) {
        if (!bytes.ended_line(line)) fail(path, "the file ends inside the header");
        const auto words = words_of(line);
        if (words.empty() || words[0] == "ply" || words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "end_header") {
            if (!format) fail(path, "the header states no format");
            header.end = bytes.at();
            return header;
        }
        bool understood = false;
        if (words[0] == "format" && words.size() == 3)
            understood = format = take_format(words, header);
        else if (words[0] == "element" && words.size() == 3)
            understood = take_element(words, header);
        else if (words[0] == "property")
            understood = take_property(path, words, header);
        if (!understood)
            fail(path, fmt::format("header line {}: '{}' is not understood", line_number,
                                   fmt::join(words, " ")));
    }
}

/// The numbers of the body, one after the other.
class Body {
  public:
    Body(const std::filesystem::path& path, BufferedBytes& bytes, const Header& header)
        : path_(path), bytes_(bytes), encoding_(header.encoding) {}

    double next(NumberKind kind, std::string_view what) {
        if (encoding_ == Encoding::ascii) return next_word(what);
        const std::endian order = order_of(encoding_);
        switch (kind) {
        case NumberKind::int8:
            return bytes_.read<std::int8_t>(what, order);
        case NumberKind::uint8:
            return bytes_.read<std::uint8_t>(what, order);
        case NumberKind::int16:
            return bytes_.read<std::int16_t>(what, order);
        case NumberKind::uint16:
            return bytes_.read<std::uint16_t>(what, order);
        case NumberKind::int32:
            return bytes_.read<std::int32_t>(what, order);
        case NumberKind::uint32:
            return bytes_.read<std::uint32_t>(what, order);
        case NumberKind::float32:
            return static_cast<double>(bytes_.read<float>(what, order));
        default:
            return bytes_.read<double>(what, order);
        }
    }

    /// All properties of an element's next row, a list's numbers left out.
    void row(const Element& element, std::uint64_t i, std::vector<double>& values) {
        const std::string what = fmt::format("{} {}", element.name, i);
        for (std::size_t k = 0; k < values.size(); ++k) {
            const Property& property = element.properties[k];
            values[k] = next(property.count.value_or(property.kind), what);
            if (!property.count) continue;
            for (double j = 0; j < values[k]; ++j) next(property.kind, what);
        }
    }

  private:
    double next_word(std::string_view what) {
        const std::string_view word = bytes_.word();
        if (word.empty()) fail(path_, fmt::format("the file ends where {} should be", what));
        double value = 0;
        const auto [next, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc())
            fail(path_, fmt::format("byte {}: {} is not a number", bytes_.at(), what));
        bytes_.skip(static_cast<std::size_t>(next - word.data()));
        return value;
    }

    const std::filesystem::path& path_;
    BufferedBytes& bytes_;
    Encoding encoding_;
};

bool has_lists(const Element& element) {
    return std::ranges::any_of(element.properties,
                               [](const Property& property) { return property.count.has_value(); });
}

/// Bytes of an element without lists, binary.
std::size_t length_of(const Element& element) {
    std::size_t length = 0;
    for (const Property& property : element.properties) length += width(property.kind);
    return length;
}

/// Which of the vertices' properties are x, y and z.
std::array<std::size_t, 3> places_of_axes(const std::filesystem::path& path,
                                          const Element& vertices) {
    std::array<std::size_t, 3> places{};
    for (std::size_t d = 0; d < 3; ++d) {
        const char axis[] = {"xyz"[d], '\0'};
        const auto found = std::ranges::find(vertices.properties, axis, &Property::name);
        if (found == vertices.properties.end() || found->count)
            fail(path, fmt::format("the vertices have no property {}", axis));
        places[d] = static_cast<std::size_t>(found - vertices.properties.begin());
    }
    return places;
}

/// Throws FileError, naming the first that is not there, unless all records of an element without
/// lists follow.
void check_records(const Element& element, BufferedBytes& bytes, Body& body) {
    const std::size_t length = length_of(element);
    const std::uint64_t whole = bytes.left() / length;
    if (whole >= element.count) return;
    bytes.seek(bytes.at() + whole * length, element.name);
    std::vector<double> row(element.properties.size());
    body.row(element, whole, row);
}

/// The records of vertices without lists, binary, that begin here.
RecordLayout vertex_records(const Element& vertices, const std::array<std::size_t, 3>& places,
                            const BufferedBytes& bytes, std::endian order) {
    RecordLayout layout{.begin = bytes.at(),
                        .count = vertices.count,
                        .length = length_of(vertices),
                        .order = order};
    for (std::size_t place : places) {
        Element before{{}, 0, vertices.properties};
        before.properties.resize(place);
        layout.fields.push_back({length_of(before), vertices.properties[place].kind});
    }
    return layout;
}

/// The vertices of a text, or of rows of different lengths.
NumberArray vertices_in_rows(const Element& vertices, const std::array<std::size_t, 3>& places,
                             Body& body) {
    NumberArray result;
    result.values.resize(3 * static_cast<std::size_t>(vertices.count));
    result.shape = {static_cast<Index>(vertices.count), 3};
    std::vector<double> row(vertices.properties.size());
    double* out = result.values.data();
    for (std::uint64_t i = 0; i < vertices.count; ++i) {
        body.row(vertices, i, row);
        for (std::size_t place : places) *out++ = row[place];
    }
    return result;
}

void skip(const Element& element, Encoding encoding, BufferedBytes& bytes, Body& body) {
    if (encoding != Encoding::ascii && !has_lists(element)) {
        check_records(element, bytes, body);
        bytes.seek(bytes.at() + element.count * length_of(element), element.name);
        return;
    }
    std::vector<double> row(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) body.row(element, i, row);
}

} // namespace

std::unique_ptr<NumberReader> open_ply(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> source) {
    BufferedBytes bytes(path, sized_and_not_empty(path, std::move(source)));
    const Header header = parse_header(path, bytes);
    Body body(path, bytes, header);
    for (const Element& element : header.elements) {
        const bool wanted = element.name == "vertex";
        if (!wanted && element.properties.empty()) continue; // however many, they are nothing
        // every property takes a byte at least: a forged count must not allocate
        if (element.count > bytes.left() && !element.properties.empty())
            fail(path, fmt::format("{} elements '{}' are stated, {} bytes are there", element.count,
                                   element.name, bytes.left()));
        if (!wanted) {
            skip(element, header.encoding, bytes, body);
            continue;
        }
        const auto places = places_of_axes(path, element);
        if (header.encoding == Encoding::ascii || has_lists(element))
            return std::make_unique<HeldNumbers>(path.string(),
                                                 vertices_in_rows(element, places, body));
        check_records(element, bytes, body);
        RecordLayout layout = vertex_records(element, places, bytes, order_of(header.encoding));
        return std::make_unique<RecordReader>(
            path.string(), bytes.release(), std::move(layout),
            std::vector<Index>{static_cast<Index>(element.count), 3});
    }
    fail(path, "there are no vertices in the file");
}

} // namespace batten
