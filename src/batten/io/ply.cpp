#include <batten/io/byte_reader.hpp>
#include <batten/io/point_formats.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/ranges.h>
#include <optional>

namespace batten {

namespace {

enum class Kind { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
    std::string name;
    Kind kind;
    std::optional<Kind> count; ///< of a list: the kind of its length
};

struct Element {
    std::string name;
    std::uint64_t count;
    std::vector<Property> properties;
};

enum class Encoding { ascii, little, big };

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::size_t end = 0;
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

Kind kind_of(const std::filesystem::path& path, std::string_view word) {
    constexpr std::array<std::array<std::string_view, 2>, 8> names{{{"char", "int8"},
                                                                    {"uchar", "uint8"},
                                                                    {"short", "int16"},
                                                                    {"ushort", "uint16"},
                                                                    {"int", "int32"},
                                                                    {"uint", "uint32"},
                                                                    {"float", "float32"},
                                                                    {"double", "float64"}}};
    for (std::size_t k = 0; k < names.size(); ++k)
        if (word == names[k][0] || word == names[k][1]) return static_cast<Kind>(k);
    fail(path, fmt::format("the header has a property of unknown type '{}'", word));
}

Header parse_header(const std::filesystem::path& path, std::string_view content) {
    Header header;
    if (!content.starts_with("ply")) fail(path, "not a PLY file: its first line is not 'ply'");
    bool format = false;
    for (std::size_t at = 0, line_number = 1;; ++line_number) {
        const std::size_t end = content.find('\n', at);
        if (end == std::string_view::npos) fail(path, "the file ends inside the header");
        const auto words = words_of(content.substr(at, end - at));
        at = end + 1;
        const auto bad = [&] {
            fail(path, fmt::format("header line {}: '{}' is not understood", line_number,
                                   fmt::join(words, " ")));
        };
        if (words.empty() || words[0] == "ply" || words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "end_header") {
            if (!format) fail(path, "the header states no format");
            header.end = at;
            return header;
        }
        if (words[0] == "format" && words.size() == 3) {
            format = true;
            if (words[1] == "ascii")
                header.encoding = Encoding::ascii;
            else if (words[1] == "binary_little_endian")
                header.encoding = Encoding::little;
            else if (words[1] == "binary_big_endian")
                header.encoding = Encoding::big;
            else
                bad();
        } else if (words[0] == "element" && words.size() == 3) {
            std::uint64_t count = 0;
            const auto [next, error] =
                std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
            if (error != std::errc() || next != words[2].data() + words[2].size()) bad();
            header.elements.push_back({std::string(words[1]), count, {}});
        } else if (words[0] == "property" && !header.elements.empty() && words.size() == 3) {
            header.elements.back().properties.push_back(
                {std::string(words[2]), kind_of(path, words[1]), std::nullopt});
        } else if (words[0] == "property" && !header.elements.empty() && words.size() == 5 &&
                   words[1] == "list") {
            header.elements.back().properties.push_back(
                {std::string(words[4]), kind_of(path, words[3]), kind_of(path, words[2])});
        } else {
            bad();
        }
    }
}

/// The numbers of the body, one after the other.
class Body {
  public:
    Body(const std::filesystem::path& path, std::string_view content, const Header& header)
        : path_(path),
          content_(content),
          bytes_(path, content),
          encoding_(header.encoding),
          at_(header.end) {
        bytes_.seek(header.end, "the body");
    }

    double next(Kind kind, std::string_view what) {
        if (encoding_ == Encoding::ascii) return next_word(what);
        const std::endian order =
            encoding_ == Encoding::big ? std::endian::big : std::endian::little;
        switch (kind) {
        case Kind::int8:
            return bytes_.read<std::int8_t>(what, order);
        case Kind::uint8:
            return bytes_.read<std::uint8_t>(what, order);
        case Kind::int16:
            return bytes_.read<std::int16_t>(what, order);
        case Kind::uint16:
            return bytes_.read<std::uint16_t>(what, order);
        case Kind::int32:
            return bytes_.read<std::int32_t>(what, order);
        case Kind::uint32:
            return bytes_.read<std::uint32_t>(what, order);
        case Kind::float32:
            return static_cast<double>(bytes_.read<float>(what, order));
        case Kind::float64:
            break;
        }
        return bytes_.read<double>(what, order);
    }
    /// Bytes that are left; of a text at least as many numbers cannot follow.
    std::size_t left() const {
        return encoding_ == Encoding::ascii ? content_.size() - at_ : bytes_.left();
    }

  private:
    double next_word(std::string_view what) {
        at_ = std::min(content_.find_first_not_of(" \t\r\n", at_), content_.size());
        if (at_ == content_.size())
            fail(path_, fmt::format("the file ends where {} should be", what));
        double value = 0;
        const char* end = content_.data() + content_.size();
        const auto [next, error] = std::from_chars(content_.data() + at_, end, value);
        if (error != std::errc())
            fail(path_, fmt::format("byte {}: {} is not a number", at_, what));
        at_ = static_cast<std::size_t>(next - content_.data());
        return value;
    }

    const std::filesystem::path& path_;
    std::string_view content_;
    ByteReader bytes_;
    Encoding encoding_;
    std::size_t at_;
};

} // namespace

NumberArray parse_ply(const std::filesystem::path& path, std::string_view content) {
    const Header header = parse_header(path, content);
    Body body(path, content, header);
    for (const Element& element : header.elements) {
        const bool wanted = element.name == "vertex";
        if (!wanted && element.properties.empty()) continue; // however many, they are nothing
        // every property takes a byte at least: a forged count must not allocate
        if (element.count > body.left() && !element.properties.empty())
            fail(path, fmt::format("{} elements '{}' are stated, {} bytes are there", element.count,
                                   element.name, body.left()));
        std::array<std::size_t, 3> place{};
        if (wanted)
            for (std::size_t d = 0; d < 3; ++d) {
                const char axis[] = {"xyz"[d], '\0'};
                const auto found = std::ranges::find(element.properties, axis, &Property::name);
                if (found == element.properties.end() || found->count)
                    fail(path, fmt::format("the vertices have no property {}", axis));
                place[d] = static_cast<std::size_t>(found - element.properties.begin());
            }
        NumberArray result;
        if (wanted) result.values.reserve(3 * static_cast<std::size_t>(element.count));
        std::vector<double> row(element.properties.size());
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const std::string what = fmt::format("{} {}", element.name, i);
            for (std::size_t k = 0; k < row.size(); ++k) {
                const Property& property = element.properties[k];
                if (!property.count) {
                    row[k] = body.next(property.kind, what);
                    continue;
                }
                const double length = body.next(*property.count, what);
                for (double j = 0; j < length; ++j) body.next(property.kind, what);
            }
            if (wanted)
                for (std::size_t d : place) result.values.push_back(row[d]);
        }
        if (!wanted) continue;
        result.shape = {static_cast<Index>(element.count), 3};
        return result;
    }
    fail(path, "there are no vertices in the file");
}

} // namespace batten
