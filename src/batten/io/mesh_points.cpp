#include <batten/io/byte_reader.hpp>
#include <batten/io/point_formats.hpp>

#include <array>
#include <charconv>
#include <set>

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
void for_each_vertex(const std::filesystem::path& path, std::string_view content,
                     std::string_view word, Vertex vertex) {
    std::size_t line_number = 0;
    for (std::size_t at = 0; at < content.size();) {
        const std::size_t end = std::min(content.find('\n', at), content.size());
        std::string_view line = content.substr(at, end - at);
        at = end + 1;
        ++line_number;
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (!line.starts_with(word) || line.size() <= word.size()) continue;
        const char after = line[word.size()];
        if (after == ' ' || after == '\t')
            vertex(three_numbers(path, line_number, line.substr(word.size())));
    }
}

NumberArray points_of(const std::filesystem::path& path, std::vector<double> values) {
    if (values.empty()) throw FileError(path.string() + ": there are no vertices in the file");
    NumberArray result;
    result.shape = {static_cast<Index>(values.size()) / 3, 3};
    result.values = std::move(values);
    return result;
}

/// Keeps the first of equal vertices: facets repeat them.
class Distinct {
  public:
    void add(const std::array<double, 3>& vertex) {
        if (seen_.insert(vertex).second) values.insert(values.end(), vertex.begin(), vertex.end());
    }
    std::vector<double> values;

  private:
    std::set<std::array<double, 3>> seen_;
};

} // namespace

NumberArray parse_obj(const std::filesystem::path& path, std::string_view content) {
    std::vector<double> values;
    for_each_vertex(path, content, "v", [&](const std::array<double, 3>& vertex) {
        values.insert(values.end(), vertex.begin(), vertex.end());
    });
    return points_of(path, std::move(values));
}

NumberArray parse_stl(const std::filesystem::path& path, std::string_view content) {
    constexpr std::size_t header = 84;
    constexpr std::size_t facet = 50;
    Distinct distinct;
    std::uint64_t count = 0;
    if (content.size() >= header) {
        ByteReader bytes(path, content);
        bytes.seek(80, "the header");
        count = bytes.read<std::uint32_t>("the number of facets");
    }
    const bool exact = content.size() >= header && content.size() == header + count * facet;
    if (content.starts_with("solid") && !exact) {
        for_each_vertex(path, content, "vertex",
                        [&](const std::array<double, 3>& vertex) { distinct.add(vertex); });
    } else {
        if (content.size() < header + count * facet || content.size() < header)
            throw FileError(fmt::format("{}: the file ends at byte {}, {} facets need {}",
                                        path.string(), content.size(), count,
                                        header + count * facet));
        ByteReader bytes(path, content);
        for (std::uint64_t i = 0; i < count; ++i) {
            bytes.seek(header + static_cast<std::size_t>(i) * facet + 12, "a facet");
            for (int corner = 0; corner < 3; ++corner) {
                std::array<double, 3> vertex{};
                for (double& x : vertex) x = static_cast<double>(bytes.read<float>("a facet"));
                distinct.add(vertex);
            }
        }
    }
    return points_of(path, std::move(distinct.values));
}

} // namespace batten
