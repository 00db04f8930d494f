#include "readers.hpp"

#include <batten/io/output_file.hpp>
#include <batten/io/point_formats.hpp>
#include <batten/io/text_reader.hpp>

#include <fmt/format.h>
#include <zlib.h>

namespace batten {
namespace {

using testing::message_of;
using testing::passed;
using testing::random_points;
using testing::Readers;
using testing::Written;
using testing::written;

/// All samples, `most` at a time.
std::vector<double> collected(SampleSource& source, Index most) {
    std::vector<double> numbers;
    source.rewind();
    for (Points part = source.next(most); !part.empty(); part = source.next(most)) {
        EXPECT_LE(part.size(), most);
        numbers.insert(numbers.end(), part.data(), part.data() + part.size() * part.dim());
    }
    return numbers;
}

std::string gzipped(const std::string& text) {
    z_stream state{};
    deflateInit2(&state, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string result(text.size() + 1000, '\0');
    std::string input = text;
    state.next_in = reinterpret_cast<Bytef*>(input.data());
    state.avail_in = static_cast<uInt>(input.size());
    state.next_out = reinterpret_cast<Bytef*>(result.data());
    state.avail_out = static_cast<uInt>(result.size());
    deflate(&state, Z_FINISH);
    result.resize(state.total_out);
    deflateEnd(&state);
    return result;
}

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

std::string npy(const std::string& type, bool fortran, const std::string& shape,
                const std::string& body) {
    std::string head = "{'descr': '" + type +
                       "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                       shape + "), }";
    head.resize(117, ' ');
    return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + body;
}

TEST_F(Readers, chunks_of_any_size_give_the_same_samples) {
    const PointSet q = random_points(40, 3, 5);
    const std::vector<float> single(q.values().begin(), q.values().end());
    const std::vector<std::int32_t> whole(single.begin(), single.end());
    write_points(path("a.csv"), q);
    write_points(path("a.npy"), q);
    write_points(path("grid.npy"), q, {5, 8});
    file("b.csv.gz", gzipped(read_file(path("a.csv"))));
    file("f.npy", npy("<f4", false, "40, 3", bytes_of(single)));
    file("fortran.npy", npy("<f4", true, "40, 3", bytes_of(single)));
    file("i.npy", npy("<i4", false, "120,", bytes_of(whole)));
    file("l.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 40\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n" +
                      bytes_of(single));
    std::string las(227, '\0');
    const auto put = [&](std::size_t at, const auto& value) {
        std::memcpy(las.data() + at, &value, sizeof value);
    };
    las.replace(0, 4, "LASF");
    put(24, char{1});
    put(25, char{2});
    put(96, std::uint32_t{227});
    put(105, std::uint16_t{20});
    put(107, std::uint32_t{40});
    for (const std::size_t d : {0, 1, 2}) put(131 + 8 * d, 0.01);
    for (std::size_t i = 0; i < 40; ++i)
        las += std::string(reinterpret_cast<const char*>(whole.data() + 3 * i), 12) + "rest1234";
    file("s.las", las);
    for (const char* name : {"a.csv", "a.npy", "grid.npy", "b.csv.gz", "f.npy", "fortran.npy",
                             "i.npy", "l.ply", "s.las"}) {
        SCOPED_TRACE(name);
        const Samples at_once = read_points(path(name));
        const std::vector<double> expected(at_once.points.data(),
                                           at_once.points.data() + at_once.size() * at_once.dim());
        ASSERT_FALSE(expected.empty());
        const auto source = open_points(path(name));
        for (Index most = 1; most <= at_once.size() + 1; ++most)
            ASSERT_EQ(collected(*source, most), expected) << most;
        EXPECT_EQ(source->size(), at_once.size());
        EXPECT_EQ(source->dim(), at_once.dim());
        EXPECT_EQ(source->grid(), at_once.grid);
        EXPECT_EQ(source->order(), at_once.order);
        if (std::string_view(name) != "fortran.npy") { // held
            EXPECT_GT(source->bytes(), 0);
        }
    }
    EXPECT_EQ(read_points(path("b.csv.gz")).points(39, 2), q(39, 2));
    EXPECT_EQ(read_points(path("s.las")).points(7, 1), whole[22] * 0.01);
}

TEST_F(Readers, what_takes_all_rows_to_know_is_known_before_a_pass) {
    const ReadOptions grid{.grid = {2, 3}};
    const ReadOptions heights{.heights = true, .spacing = {2, 0.5}};
    const auto same = [&](const std::string& name, const std::string& content,
                          const ReadOptions& options = {}) {
        const Samples at_once = read_points(file(name, content), options);
        const auto source = open_points(path(name), options);
        for (const Index most : {1, 2, 100}) {
            const std::vector<double> got = collected(*source, most);
            EXPECT_TRUE(std::equal(got.begin(), got.end(), at_once.points.data())) << content;
            EXPECT_EQ(static_cast<Index>(got.size()), at_once.size() * at_once.dim());
        }
        EXPECT_EQ(source->notes(), at_once.notes);
        EXPECT_EQ(source->grid(), at_once.grid);
        EXPECT_EQ(source->spacing(), at_once.spacing);
    };
    same("a.csv", ",x,y\n0,5,6\n1,7,8\n2,9,1\n");
    same("a.csv", ",x,y\n0,5,6\n1,7,8\n3,9,1\n");
    same("a.dat", "GOE\n3. 3.\n\n0 0\n.5 .1\n1 0\n\n0 0\n.5 -.1\n1 0\n");
    same("a.csv", "1,2\n3,4\n5,6\n7,8\n9,1\n2,3\n", grid);
    same("a.csv", "1,2,3\n4,5,6\n", heights);
    write_points(path("h.npy"), random_points(6, 4, 1));
    same("h.npy", read_file(path("h.npy")), heights);
    const auto source = open_points(file("a.csv", "1,2\n3,4\n5,6\n7,8\n"), {.grid = {3, 2}});
    EXPECT_EQ(message_of<InvalidInput>([&] { collected(*source, 3); }),
              "grid: 3x2 needs 6 samples, got 4");
    const auto more = open_points(path("a.csv"), {.grid = {1, 2}});
    EXPECT_EQ(message_of<InvalidInput>([&] { collected(*more, 3); }),
              "grid: 1x2 needs 2 samples, got 4");
}

TEST_F(Readers, a_chunk_that_is_not_finite_names_its_place) {
    const auto words = [&](const std::string& name, const std::string& content) {
        const auto source = open_points(file(name, content));
        return message_of<InvalidInput>([&] { collected(*source, 2); });
    };
    EXPECT_EQ(words("a.csv", "x,y\n1,2\n\n3,nan\n5,6\n"),
              path("a.csv") + ":4: sample 1: its coordinates (3, nan) must be finite numbers");
    EXPECT_EQ(words("a.csv", "x,y\ninf,2\n3,nan\n5,6\n"),
              path("a.csv") + ":2: sample 0: its coordinates (inf, 2) must be finite numbers");
    const double nan = std::nan("");
    EXPECT_EQ(words("a.npy", npy("<f8", false, "3, 2", bytes_of<double>({1, 2, 3, 4, 5, nan}))),
              path("a.npy") + ": sample 2: its coordinates (5, nan) must be finite numbers");
}

TEST_F(Readers, a_file_that_changes_is_refused) {
    const PointSet q = random_points(400, 2, 1);
    for (const std::string name : {"a.csv", "a.npy"}) {
        write_points(path(name), q);
        const auto before = std::filesystem::file_size(path(name));
        const auto source = open_points(path(name));
        EXPECT_EQ(source->next(3).size(), 3);
        std::filesystem::resize_file(path(name), before / 2);
        EXPECT_EQ(message_of<FileError>([&] { collected(*source, 50); }),
                  fmt::format("{}: changed while it was read: {} bytes before, {} now", path(name),
                              before, before / 2));
    }
    write_points(path("a.csv"), q);
    const auto grown = open_points(path("a.csv"));
    EXPECT_EQ(collected(*grown, 50).size(), 800U);
    std::ofstream(path("a.csv"), std::ios::app) << "1,2\n";
    EXPECT_THROW(grown->rewind(), FileError);
    write_points(path("a.csv"), q);
    const auto touched = open_points(path("a.csv"));
    touched->next(3);
    std::filesystem::last_write_time(path("a.csv"), std::filesystem::file_time_type());
    EXPECT_EQ(message_of<FileError>([&] { touched->rewind(); }),
              path("a.csv") + ": changed while it was read: written to");
    // a file that takes the name is another one: the open one can be read on
    write_points(path("a.csv"), q);
    const auto replaced = open_points(path("a.csv"));
    write_points(path("a.csv"), random_points(5, 2, 2));
    EXPECT_EQ(collected(*replaced, 50), q.values());
}

TEST_F(Readers, compressed_text_is_refused_when_it_is_damaged) {
    const std::string good = gzipped("x,y\n1,2\n3,4\n");
    const auto words = [&](const std::string& content) {
        const std::string p = file("a.csv.gz", content);
        return message_of<FileError>([&] { read_points(p); }).substr(p.size());
    };
    EXPECT_EQ(read_points(file("a.csv.gz", good + gzipped("5,6\n") + std::string(9, '\0'))).size(),
              3);
    EXPECT_EQ(words(good.substr(0, good.size() - 9)), ": the compressed file ends too early");
    std::string wrong = good;
    wrong[good.size() - 8] ^= 1;
    EXPECT_EQ(words(wrong), ": not a sound .gz file: incorrect data check");
    EXPECT_EQ(words("1,2\n"), ": not a sound .gz file: incorrect header check");
    EXPECT_EQ(words(""), ": the file is empty");
    EXPECT_EQ(words(gzipped("1,2\n3\n")), ":2: 1 number where the rows before have 2");
    EXPECT_EQ(message_of<InvalidInput>([&] { read_points(path("a.npy.gz")); }),
              path("a.npy.gz") + ": unknown extension of compressed points '.npy'; known: .csv, "
                                 ".txt, .xyz, .dat");
    EXPECT_EQ(message_of<InvalidInput>([&] { write_points(path("b.csv.gz"), PointSet(2, 2)); }),
              path("b.csv.gz") + ": .gz files of points are read, not written");
}

/// Bytes that come once, as through a pipe.
class Once final : public ByteSource {
  public:
    explicit Once(std::string_view bytes) : bytes_(bytes_in_memory(bytes)) {}
    std::int64_t size() const override { return -1; }
    std::size_t read(std::span<char> into) override { return bytes_->read(into); }
    void seek(std::uint64_t) override { FAIL() << "a pipe has no way back"; }

  private:
    std::unique_ptr<ByteSource> bytes_;
};

TEST_F(Readers, a_pipe_is_kept_for_another_pass) {
    const Written w = written({",", "", false, "\n", true, 200}, 5);
    TextReader reader("-", spooled("standard input", std::make_unique<Once>(w.text)), {256, 64});
    double some[5];
    reader.rewind(); // nothing was handed out yet
    EXPECT_TRUE(reader.notes().empty());
    reader.read(some);
    EXPECT_EQ(passed(reader, 7), w.numbers); // from the file first, then on from the pipe
    EXPECT_EQ(passed(reader, 100), w.numbers);
    EXPECT_EQ(reader.notes(), std::vector<std::string>{
                                  "standard input: kept in a temporary file, to be read more than "
                                  "once"});
    write_points(path("a.npy"), random_points(9, 2, 3));
    const std::string bytes = read_file(path("a.npy"));
    const auto array = open_npy("pipe.npy", std::make_unique<Once>(bytes));
    EXPECT_EQ(passed(*array, 4), random_points(9, 2, 3).values());
}

} // namespace
} // namespace batten
