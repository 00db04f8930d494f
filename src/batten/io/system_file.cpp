#include <batten/io/system_file.hpp>

#include <batten/core/counts.hpp>
#include <batten/io/buffered_bytes.hpp>
#include <batten/io/checksum.hpp>
#include <batten/io/output_file.hpp>
#include <batten/system/half_stencil.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

// the first byte is no text's, the line ends tell a file that was copied as text
constexpr std::string_view magic = "\x89"
                                   "BSYS\r\n\x1a";
constexpr std::uint32_t version = 1;
constexpr std::uint64_t most_knots = std::uint64_t{1} << 40U;

/// How the matrix is stored.
enum class Kind : std::uint32_t { factors = 1, stencil = 2, stencil_of_grid = 3 };

Kind kind_of(const SystemSums& sums) {
    return !sums.factors.empty()     ? Kind::factors
           : sums.grid_means.empty() ? Kind::stencil
                                     : Kind::stencil_of_grid;
}

/// Calls `visit` for every array of numbers in the file's order; the axes' knots come before.
template <class Sums, class Visit>
void for_each_array(Sums& sums, Visit visit) {
    visit(std::span(sums.centre));
    visit(std::span(sums.box.values()));
    visit(std::span(&sums.weight, 1));
    visit(std::span(&sums.energy, 1));
    visit(std::span(sums.rhs.values()));
    visit(std::span(sums.stencil));
    for (auto* matrices : {&sums.factors, &sums.axis_sums, &sums.grid_means})
        for (auto& matrix : *matrices) visit(matrix.values());
}

class ByteWriter {
  public:
    template <class Number>
    void write(Number value) {
        char bytes[sizeof(Number)];
        std::memcpy(bytes, &value, sizeof(Number));
        if (std::endian::native != std::endian::little) std::ranges::reverse(bytes);
        content.append(bytes, sizeof(Number));
    }
    void write(std::span<const double> values) {
        for (double value : values) write(value);
    }

    std::string content{};
};

/// The file's first numbers, from which the lengths of all arrays follow.
struct Header {
    Kind kind;
    Index dim;
    Index samples;
    std::vector<int> degree;
    std::vector<Closure> closure;
    std::vector<Index> knots;

    std::size_t axes() const { return degree.size(); }
    /// Free control points along an axis.
    Index count(std::size_t k) const {
        return knots[k] - degree[k] - 1 - (closure[k] == Closure::closed ? degree[k] : 0);
    }
};

class Parser {
  public:
    Parser(const std::filesystem::path& path, std::string_view content)
        : path_(path), content_(content), bytes_(path, bytes_in_memory(content)) {}

    SystemSums operator()() {
        if (!content_.starts_with(magic))
            fail("not a saved system: its first bytes are not those of one");
        bytes_.seek(magic.size(), "the header");
        if (const auto found = number<std::uint32_t>(); found != version)
            fail(fmt::format("a saved system of version {}; version {} is read", found, version));
        const Header header = read_header();
        check_length(header);
        const std::size_t end = content_.size() - sizeof(std::uint64_t);
        BufferedBytes last(path_, bytes_in_memory(content_));
        last.seek(end, "the checksum");
        if (last.read<std::uint64_t>("the checksum") != checksum(content_.substr(0, end)))
            fail("damaged: its checksum does not match");
        SystemSums sums = sized(header);
        for_each_array(sums, [&](std::span<double> values) {
            for (double& value : values) value = finite();
        });
        check_numbers(sums);
        return sums;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw FileError(fmt::format("{}: {}", path_.string(), what));
    }

    template <class Number>
    Number number() {
        return bytes_.read<Number>("a number of the saved system");
    }

    double finite() {
        const auto value = number<double>();
        if (!std::isfinite(value))
            fail(fmt::format("the number before byte {} is not finite", bytes_.at()));
        return value;
    }

    /// A count within bounds, so that no sum of few of them leaves an Index.
    Index counted(std::uint64_t value, std::uint64_t least, std::uint64_t most,
                  std::string_view what) const {
        if (value < least || value > most)
            fail(fmt::format("damaged: {} of {}, {} to {} are possible", what, value, least, most));
        return static_cast<Index>(value);
    }

    Header read_header() {
        Header header{};
        header.kind = static_cast<Kind>(counted(number<std::uint32_t>(), 1, 3, "a kind"));
        const Index axes = counted(number<std::uint32_t>(), 1, 3, "a number of axes");
        header.dim = counted(number<std::uint32_t>(), 1, 16, "a number of coordinates");
        header.samples = counted(number<std::uint64_t>(), 1, most_knots, "a number of samples");
        for (Index k = 0; k < axes; ++k) {
            const Index degree = counted(number<std::uint32_t>(), 1, max_degree, "a degree");
            const bool closed = counted(number<std::uint32_t>(), 0, 1, "a closure") == 1;
            const Index least = 2 * (degree + 1) + (closed ? degree : 0);
            header.degree.push_back(static_cast<int>(degree));
            header.closure.push_back(closed ? Closure::closed : Closure::open);
            header.knots.push_back(counted(number<std::uint64_t>(),
                                           static_cast<std::uint64_t>(least), most_knots,
                                           "a number of knots"));
        }
        return header;
    }

    /// Numbers of the matrix, all axes' counts being in bounds.
    std::vector<Index> matrix_counts(const Header& header) const {
        Index all = 1;
        Index places = 1;
        Index bands = 0;
        for (std::size_t k = 0; k < header.axes(); ++k) {
            all = checked_product(std::array{all, header.count(k)}, "control points");
            places *= k == 0 ? header.degree[0] + 1 : 2 * header.degree[k] + 1;
            bands += header.count(k) * (header.degree[k] + 1);
        }
        const Index rhs = checked_product(std::array{all, header.dim}, "right sides");
        if (header.kind == Kind::factors) return {rhs, bands};
        const Index stencil = checked_product(std::array{all, places}, "entries");
        return {rhs, stencil, header.kind == Kind::stencil ? bands : 2 * bands};
    }

    /// Before anything of that length is allocated.
    void check_length(const Header& header) const {
        const std::size_t rest = content_.size() - bytes_.at();
        const std::size_t most = content_.size(); // far below any sum's overflow
        std::size_t wanted = 3 * static_cast<std::size_t>(header.dim) + 3; // and the checksum
        try {
            std::vector<Index> counts = matrix_counts(header);
            counts.insert(counts.end(), header.knots.begin(), header.knots.end());
            for (Index count : counts) wanted += std::min(static_cast<std::size_t>(count), most);
        } catch (const InvalidInput&) { // more than can be counted
            wanted = most;
        }
        if (wanted > rest / sizeof(double))
            fail(fmt::format("cut off, or damaged: {} bytes are too few for what its header says",
                             content_.size()));
        if (wanted * sizeof(double) != rest)
            fail(fmt::format("damaged: {} bytes are left over after what its header says",
                             rest - wanted * sizeof(double)));
    }

    SystemSums sized(const Header& header) {
        SystemSums sums{.samples = header.samples};
        std::vector<Index> shape;
        for (std::size_t k = 0; k < header.axes(); ++k) {
            std::vector<double> knots(static_cast<std::size_t>(header.knots[k]));
            for (double& knot : knots) knot = finite();
            try {
                sums.axes.emplace_back(header.degree[k], std::move(knots), header.closure[k]);
            } catch (const InvalidInput& error) {
                fail(fmt::format("axis {}: {}", k, error.what()));
            }
            shape.push_back(sums.axes[k].free_count());
        }
        const Index size = GridIndex(shape).size();
        sums.centre.resize(static_cast<std::size_t>(header.dim));
        sums.box = PointSet(2, header.dim);
        sums.rhs = PointSet(size, header.dim);
        std::vector<BandedMatrix> matrices;
        for (const KnotVector& axis : sums.axes)
            matrices.emplace_back(axis.free_count(), axis.degree(), axis.closure());
        if (header.kind == Kind::factors) {
            sums.factors = std::move(matrices);
            return sums;
        }
        sums.stencil.resize(static_cast<std::size_t>(half_stencil(sums.axes).size() * size));
        sums.axis_sums = matrices;
        if (header.kind == Kind::stencil_of_grid) sums.grid_means = std::move(matrices);
        return sums;
    }

    void check_numbers(const SystemSums& sums) const {
        if (!(sums.weight > 0)) fail(fmt::format("a weight of {}: not of samples", sums.weight));
        if (sums.energy < 0)
            fail(fmt::format("a sum of squares of {}: not of samples", sums.energy));
        for (Index d = 0; d < sums.box.dim(); ++d)
            if (sums.box(0, d) > sums.box(1, d))
                fail(fmt::format("coordinate {} from {} to {}: not of samples", d, sums.box(0, d),
                                 sums.box(1, d)));
    }

    const std::filesystem::path& path_;
    std::string_view content_;
    BufferedBytes bytes_;
};

} // namespace

std::string system_content(const SystemSums& sums) {
    if (sums.box.size() != 2)
        throw InvalidInput("a system to be saved: the box of its samples is not stated");
    ByteWriter file;
    file.content = magic;
    file.write(version);
    file.write(static_cast<std::uint32_t>(kind_of(sums)));
    file.write(static_cast<std::uint32_t>(sums.axes.size()));
    file.write(static_cast<std::uint32_t>(sums.rhs.dim()));
    file.write(static_cast<std::uint64_t>(sums.samples));
    for (const KnotVector& axis : sums.axes) {
        file.write(static_cast<std::uint32_t>(axis.degree()));
        file.write(static_cast<std::uint32_t>(axis.closed() ? 1 : 0));
        file.write(static_cast<std::uint64_t>(axis.knots().size()));
    }
    for (const KnotVector& axis : sums.axes) file.write(axis.knots());
    for_each_array(sums, [&](std::span<const double> values) { file.write(values); });
    file.write(checksum(file.content));
    return std::move(file.content);
}

SystemSums parse_system(const std::filesystem::path& path, std::string_view content) {
    return Parser(path, content)();
}

void save_system(const std::filesystem::path& path, const SystemSums& sums) {
    write_file(path, system_content(sums));
}

SystemSums load_system(const std::filesystem::path& path) {
    return parse_system(path, read_file(path));
}

} // namespace batten
