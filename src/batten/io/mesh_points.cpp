#include <batten/io/buffered_bytes.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/record_reader.hpp>

#include <array>
#include <charconv>
#include <fmt/format.h>
#include <unordered_set>

namespace batten {

namespace {

/// `count` numbers after the first word of a line; throws FileError with path and line.
std::array<double, 3> three_numbers(const std::filesystem::path& path, std::size_t line_number,
                                    std::string_view text) {
    std::array<double, 3> result{};
    for (double& x : result) {
        const std::size_t first = std::min(text.find_first_not_of(" \t"), text.size());
        text.remove_prefix(first);
        const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), x);
        if (error != std::errc())
            throw FileError(
                fmt::format("{}:{}: a vertex needs three numbers", path.string(), line_number));
        text.remove_prefix(static_cast<std::size_t>(next - text.data()));
    }
    return result;
}

/// Calls `vertex` for each line whose first word is `word`.
template <class Vertex>
void for_each_vertex(const std::filesystem::path& path, BufferedBytes& bytes, std::string_view word,
                     Vertex vertex) {
    std::string_view line;
    for (std::size_t line_number = 1; bytes.line(line); ++line_number) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (!line.starts_with(word) || line.size() <= word.size()) continue;
        const char after = line[word.size()];
        if (after == ' ' || after == '\t')
            vertex(three_numbers(path, line_number, line.substr(word.size())));
    }
}

/// Vertices as they are found, one after the other or each once: facets repeat them.
class Vertices {
  public:
    enum class Repeated { kept, left_out };
    explicit Vertices(Repeated repeated) : repeated_(repeated) {}

    void add(const std::array<double, 3>& vertex) {
        const std::size_t begin = values_.size();
        values_.resize(begin + 3);
        std::ranges::copy(vertex, values_.data() + begin);
        if (repeated_ == Repeated::left_out && !seen_.insert(begin).second) values_.resize(begin);
    }

    std::unique_ptr<NumberReader> take(const std::filesystem::path& path) {
        if (values_.empty()) throw FileError(path.string() + ": there are no vertices in the file");
        const auto count = static_cast<Index>(values_.size()) / 3;
        return std::make_unique<HeldNumbers>(path.string(),
                                             NumberArray{std::move(values_), {count, 3}, {}});
    }

  private:
    /// Compare what stands at these places.
    struct Hash {
        const LargeArray& values;
        std::size_t operator()(std::size_t at) const {
            std::size_t result = 0;
            for (std::size_t d = 0; d < 3; ++d) // zeros of both signs are one number
                result = result * 0x9E3779B97F4A7C15U + std::hash<double>()(values[at + d]);
            return result ^ (result >> 32U);
        }
    };
    struct Equal {
        const LargeArray& values;
        bool operator()(std::size_t a, std::size_t b) const {
            return std::equal(values.data() + a, values.data() + a + 3, values.data() + b);
        }
    };

    Repeated repeated_;
    LargeArray values_;
    std::unordered_set<std::size_t, Hash, Equal> seen_{64, Hash{values_}, Equal{values_}};
};

} // namespace

std::unique_ptr<NumberReader> open_obj(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> source) {
    BufferedBytes bytes(path, sized_and_not_empty(path, std::move(source)));
    Vertices vertices(Vertices::Repeated::kept);
    for_each_vertex(path, bytes, "v", [&](const auto& vertex) { vertices.add(vertex); });
    return vertices.take(path);
}

std::unique_ptr<NumberReader> open_stl(const std::filesystem::path& path,
                                       std::unique_ptr<ByteSource> source) {
    constexpr std::size_t header = 84;
    constexpr std::size_t facet = 50;
    BufferedBytes bytes(path, sized_and_not_empty(path, std::move(source)));
    Vertices vertices(Vertices::Repeated::left_out);
    std::uint64_t count = 0;
    if (bytes.size() >= header) {
        bytes.seek(80, "the header");
        count = bytes.read<std::uint32_t>("the number of facets");
        bytes.seek(0, "the header");
    }
    const std::uint64_t needed = header + count * facet;
    if (bytes.starts_with("solid") && bytes.size() != needed) {
        for_each_vertex(path, bytes, "vertex", [&](const auto& vertex) { vertices.add(vertex); });
        return vertices.take(path);
    }
    if (bytes.size() < needed)
        throw FileError(fmt::format("{}: the file ends at byte {}, {} facets need {}",
                                    path.string(), bytes.size(), count, needed));
    RecordLayout layout{.begin = header, .count = count, .length = facet};
    for (std::size_t k = 0; k < 9; ++k) // three corners after the normal
        layout.fields.push_back({.place = 12 + 4 * k, .kind = NumberKind::float32});
    RecordReader facets(path.string(), bytes.release(), std::move(layout),
                        {static_cast<Index>(count), 9});
    std::vector<double> part(9 * 4096);
    while (const std::size_t got = facets.read(part))
        for (std::size_t k = 0; k < got; k += 3) vertices.add({part[k], part[k + 1], part[k + 2]});
    return vertices.take(path);
}

} // namespace batten
