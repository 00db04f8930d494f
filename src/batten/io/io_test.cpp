#include "problems.hpp"

#include <batten/io/sampling.hpp>

#include <batten/io/output_file.hpp>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace batten {
namespace {

using testing::message_of;
using testing::random_points;

/// A folder of its own that goes with the test.
class Files : public ::testing::Test {
  protected:
    Files()
        : folder_(std::filesystem::temp_directory_path() /
                  ("batten-io-" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Files() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string file(const std::string& name, const std::string& content) const {
        std::ofstream(path(name), std::ios::binary) << content;
        return path(name);
    }
    /// The message of reading `content`, without the folder.
    std::string refusal(const std::string& name, const std::string& content,
                        const ReadOptions& options = {}) const {
        const std::string p = file(name, content);
        std::string what;
        try {
            read_points(p, options);
        } catch (const std::exception& error) {
            what = error.what();
        }
        const std::size_t at = what.find(p);
        return at == std::string::npos ? what : what.replace(at, p.size(), name);
    }
    std::filesystem::path folder_;
};

TEST_F(Files, points_survive_every_format_exactly) {
    const PointSet q = random_points(37, 3, 1);
    for (const char* name : {"a.csv", "a.txt", "a.xyz", "a.dat", "a.npy"}) {
        write_points(path(name), q);
        const Samples back = read_points(path(name));
        ASSERT_EQ(back.size(), 37) << name;
        EXPECT_TRUE(std::equal(q.values().begin(), q.values().end(), back.points.data())) << name;
    }
    write_points(path("grid.npy"), random_points(24, 2, 2), {4, 6});
    EXPECT_EQ(read_points(path("grid.npy")).grid, (std::vector<Index>{4, 6}));
}

TEST_F(Files, a_spline_survives_json_exactly) {
    const Spline s = Spline::from_free(
        {uniform_knots(3, 7, 0, 1, Closure::closed), uniform_knots(2, 5, -1, 1e-3)},
        random_points(35, 3, 3));
    write_spline(path("s.json"), {s, nullptr, ""});
    const Spline back = read_spline(path("s.json"));
    EXPECT_EQ(back.axes(), s.axes());
    EXPECT_EQ(back.control_points().values(), s.control_points().values());
}

TEST_F(Files, text_comes_in_many_layouts) {
    const auto rows = [&](const std::string& name, const std::string& content) {
        return read_points(file(name, content)).points;
    };
    EXPECT_EQ(rows("a.csv", "x,y\n1,2\n3,4\n").size(), 2);
    EXPECT_EQ(rows("a.csv", "\xEF\xBB\xBFx;y\r\n1;2\r\n\r\n3 ; +4e0\r\n")(1, 1), 4);
    EXPECT_EQ(rows("a.xyz", "# a comment\n 1\t2  3\n4 5 6 # more\n").dim(), 3);
    EXPECT_EQ(
        rows("a.dat", "20-32C AIRFOIL\nsecond title\n1 0\n0 0\n1 0.1\nnotes, with 5 numbers\n")
            .size(),
        3);
    EXPECT_EQ(rows("a.dat", "2412\n1 0\n0 0\n1 0.1\n").size(), 3);
    EXPECT_EQ(rows("a.dat", "NC130\n-2 3 -2 3\n1 0\n0 0\n1 0.1\n").size(), 3);
    // two blocks from the leading edge: joined around the section, the leading edge once
    const Points joined = rows("a.dat", "GOE\n3. 3.\n\n0 0\n.5 .1\n1 0\n\n0 0\n.5 -.1\n1 0\n");
    ASSERT_EQ(joined.size(), 5);
    EXPECT_EQ(joined(0, 0), 1);
    EXPECT_EQ(joined(1, 1), 0.1);
    EXPECT_EQ(joined(2, 0), 0);
    EXPECT_EQ(joined(3, 1), -0.1);
}

TEST_F(Files, heights_become_a_grid) {
    const Samples s = read_points(file("h.csv", "1,2,3\n4,5,6\n"),
                                  {.grid = {}, .heights = true, .spacing = {2, 0.5}});
    EXPECT_EQ(s.grid, (std::vector<Index>{2, 3}));
    EXPECT_EQ(s.points(5, 0), 2);
    EXPECT_EQ(s.points(5, 1), 1);
    EXPECT_EQ(s.points(5, 2), 6);
}

TEST_F(Files, bad_text_is_refused_with_its_place) {
    EXPECT_EQ(refusal("a.csv", "1,2\n3,4,5\n"), "a.csv:2: 3 numbers where the rows before have 2");
    EXPECT_EQ(refusal("a.csv", "x,y\n1,2\n3, four\n"), "a.csv:3:4: 'four' is not a number");
    EXPECT_EQ(refusal("a.csv", "x,y\nnames,again\n1,2\n"), "a.csv:2:1: 'names' is not a number");
    EXPECT_EQ(refusal("a.csv", "1,,2\n"), "a.csv:1:3: '' is not a number");
    EXPECT_EQ(refusal("a.csv", ""), "a.csv: the file is empty");
    EXPECT_EQ(refusal("a.csv", "# nothing\n"), "a.csv: no points in the file");
    EXPECT_EQ(refusal("a.csv", "1,2\n3,nan\n"),
              "sample 1: its coordinates (3, nan) must be finite numbers");
    EXPECT_EQ(refusal("a.csv", "1,2\n-inf,3\n"),
              "sample 1: its coordinates (-inf, 3) must be finite numbers");
    EXPECT_EQ(refusal("a.dat", "T\n1 2\n3 4\nnotes\n5 6\n"),
              "a.dat:5: numbers after a line of text that ended the points");
    EXPECT_EQ(refusal("a.csv", "1,2\n3,4\n", {.grid = {3, 3}}), "grid: 3x3 needs 9 samples, got 2");
    EXPECT_EQ(refusal("a.pts", "1,2\n"),
              "a.pts: unknown extension of points '.pts'; did you mean '.ply'?");
}

TEST_F(Files, missing_files_and_folders_are_file_trouble) {
    EXPECT_EQ(message_of<FileError>([&] { read_points(path("none.csv")); }),
              path("none.csv") + ": cannot be read: No such file or directory");
    std::filesystem::create_directories(path("folder.csv"));
    EXPECT_EQ(message_of<FileError>([&] { read_points(path("folder.csv")); }),
              path("folder.csv") + ": cannot be read: Is a directory");
    EXPECT_EQ(message_of<FileError>([&] { check_output(path("no/where.json")); }),
              path("no/where.json") + ": the folder " + path("no") + " does not exist");
    const std::string words = message_of<InvalidInput>([&] { check_output(path("a.jsn")); });
    EXPECT_TRUE(
        words.starts_with(path("a.jsn") + ": unknown extension '.jsn'; known: .json, .svg, .obj"));
}

TEST_F(Files, npy_of_no_axes_or_no_numbers_reads_nothing_beyond_its_end) {
    const auto npy = [&](const std::string& shape, const std::string& body) {
        std::string head = "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }";
        return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(head.size()) + '\0' + head +
               body;
    };
    write_file(path("a.npy"), npy("()", "abc"));
    EXPECT_EQ(message_of<FileError>([&] { read_points(path("a.npy")); }),
              path("a.npy") + ": a number is stated, 3 bytes are there");
    write_file(path("a.npy"), npy("(0, 2)", ""));
    EXPECT_EQ(message_of<InvalidInput>([&] { read_points(path("a.npy")); }),
              "samples: there are none");
}

TEST_F(Files, npy_of_other_types_and_orders_is_read) {
    const auto header = [](const std::string& type, bool fortran, const std::string& shape) {
        std::string text = "{'descr': '" + type +
                           "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                           shape + "), }";
        text.resize(117, ' ');
        return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + text + "\n";
    };
    const Samples big = read_points(
        file("b.npy", header(">i2", false, "2, 2") + std::string("\0\1\0\2\0\3\xff\xff", 8)));
    EXPECT_EQ(big.points(1, 1), -1);
    const Samples fortran =
        read_points(file("f.npy", header("|u1", true, "2, 3") + std::string("\1\4\2\5\3\6", 6)));
    EXPECT_EQ(fortran.points(0, 1), 2);
    EXPECT_EQ(fortran.points(1, 2), 6);
    EXPECT_EQ(refusal("c.npy", header("<f8", false, "2, 2") + "short"),
              "c.npy: shape 2x2 needs more numbers than the 0 in the file");
    EXPECT_EQ(refusal("c.npy", header("<f8", false, "99999999999, 9999999999, 3")),
              "c.npy: shape 99999999999x9999999999x3 needs more numbers than the 0 in the file");
    EXPECT_EQ(refusal("c.npy", header("<c16", false, "2, 2")).substr(0, 6), "c.npy:");
    EXPECT_EQ(refusal("c.npy", "not numpy at all"),
              "c.npy: not a .npy file: its first bytes are not \\x93NUMPY");
    EXPECT_EQ(refusal("c.npy", std::string("\x93NUMPY\x01\x00\x76\x00{'de", 14)),
              "c.npy: the file ends inside the header: 118 bytes stated, 4 there");
    EXPECT_EQ(refusal("c.npy", header("|u1", false, "2, 20") + std::string(40, 'x')),
              "c.npy: 2x20 means points of dimension 20, outside 1 to 16; heights reads it as a "
              "grid of heights");
}

TEST_F(Files, bad_json_is_refused) {
    const auto words = [&](const std::string& content) {
        const std::string p = file("s.json", content);
        return message_of<FileError>([&] { read_spline(p); }).substr(p.size());
    };
    EXPECT_EQ(words("{}"), ": \"format\" is not \"batten-spline\"");
    EXPECT_TRUE(words("{\"format\": ").starts_with(": parse error at line 1, column"));
    EXPECT_EQ(words(R"({"format":"batten-spline","version":2})"), ": version 2 is not 1");
    EXPECT_EQ(
        words(
            R"({"format":"batten-spline","version":1,"degree":[1],"knots":[[0,0,1,1]],"control_shape":[3],"control_points":[[0],[1]]})"),
        ": axis 0: 4 knots of degree 1 make 2 control points, control_shape says 3");
    EXPECT_EQ(
        words(
            R"({"format":"batten-spline","version":1,"degree":[1],"knots":[[0,0,1,1]],"control_shape":[2],"control_points":[[0],[1,2]]})"),
        ": control point 1 has 2 coordinates, the first has 1");
}

TEST_F(Files, a_failed_write_leaves_the_old_file) {
    write_file(path("a.json"), "old");
    // where no file can be made: a folder stands at the place of the output
    std::filesystem::create_directories(path("b.json/full"));
    EXPECT_THROW(write_file(path("b.json"), "new"), FileError);
    std::filesystem::remove_all(path("b.json"));
    EXPECT_EQ(read_file(path("a.json")), "old");
    EXPECT_EQ(message_of<FileError>([] { write_file("/dev/full/x", "new"); }),
              "/dev/full/x: cannot be written: Not a directory");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}),
              1); // no temporary file stays
}

TEST_F(Files, a_picture_shows_exact_pieces) {
    const Spline parabola({KnotVector(2, {0, 0, 0, 1, 1, 1})}, PointSet({0, 0, 1, 2, 2, 0}, 2));
    write_spline(path("p.svg"), {parabola, nullptr, "<a & b>"});
    const std::string svg = read_file(path("p.svg"));
    EXPECT_NE(svg.find("<title>&lt;a &amp; b&gt;</title>"), std::string::npos);
    // degree elevation: the inner cubic points are 1/3 P0 + 2/3 P1 and 2/3 P1 + 1/3 P2 at 450
    // pixels a unit
    EXPECT_NE(svg.find("C 336.000 336.000, 636.000 336.000, 936.000 936.000"), std::string::npos)
        << svg;
    const Spline line({KnotVector(1, {0, 0, 1, 1})}, PointSet(2, 4));
    EXPECT_EQ(message_of<InvalidInput>([&] { write_spline(path("q.svg"), {.spline = line}); }),
              "an .svg picture shows the plane, space and functions of one and two variables, this "
              "spline has 1 axis in dimension 4");
    EXPECT_FALSE(std::filesystem::exists(path("q.svg")));
}

TEST(Sampling, stays_within_the_chord) {
    const Spline spline =
        fit(generate("peaks", {}), {.shape = {.control_points = {20, 25}}}).spline;
    for (double chord : {0.3, 0.03}) {
        const auto t = sampling(spline, chord);
        double worst = 0;
        for (std::size_t i = 0; i + 1 < t[0].size(); i += 3)
            for (std::size_t j = 0; j + 1 < t[1].size(); j += 3) {
                const auto at = [&](double u, double v) { return spline(std::array{u, v}); };
                const auto a = at(t[0][i], t[1][j]);
                const auto c = at(t[0][i + 1], t[1][j + 1]);
                const auto m = at((t[0][i] + t[0][i + 1]) / 2, (t[1][j] + t[1][j + 1]) / 2);
                // half-way along the diagonal that parts the cell into triangles
                double square = 0;
                for (std::size_t d = 0; d < 3; ++d) square += std::pow(m[d] - (a[d] + c[d]) / 2, 2);
                worst = std::max(worst, std::sqrt(square));
            }
        EXPECT_LT(worst, chord);
        EXPECT_GT(worst, chord / 50); // and not far denser than that
    }
    EXPECT_EQ(message_of<InvalidInput>([&] { sampling(spline, 1e-12); }),
              "chord tolerance 1e-12: more than 1e+07 points would be needed");
    EXPECT_EQ(message_of<InvalidInput>([&] { sampling(spline, 0); }),
              "chord tolerance 0: must be positive and finite");
}

} // namespace
} // namespace batten
