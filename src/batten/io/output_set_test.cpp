#include <batten/core/errors.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/output_set.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/staged_file.hpp>

#include <array>
#include <cmath>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

using namespace batten;
namespace fs = std::filesystem;

template <class Error, class Work>
std::string message_of(Work work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

class Outputs : public ::testing::Test {
  protected:
    Outputs() : folder_(fs::temp_directory_path() / ("batten_outputs" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
    }
    ~Outputs() override { fs::remove_all(folder_); }
    fs::path path(const char* name) const { return folder_ / name; }
    std::string content(const char* name) const {
        std::ifstream file(path(name));
        return {std::istreambuf_iterator<char>(file), {}};
    }
    long files() const { return std::distance(fs::directory_iterator(folder_), {}); }

    fs::path folder_;
};

TEST_F(Outputs, appear_together) {
    std::ofstream(path("a")) << "old";
    OutputSet set;
    set.add(path("a"), "one");
    set.add(path("b"), "two");
    EXPECT_EQ(content("a"), "old");
    EXPECT_FALSE(fs::exists(path("b")));
    set.put_in_place();
    EXPECT_EQ(content("a"), "one");
    EXPECT_EQ(content("b"), "two");
    EXPECT_EQ(files(), 2);
    EXPECT_TRUE(any_put_in_place());
}

TEST_F(Outputs, vanish_with_a_set_that_is_left) {
    std::ofstream(path("a")) << "old";
    {
        OutputSet set;
        set.add(path("a"), "one");
        set.add(path("b"), "two");
        EXPECT_EQ(message_of<FileError>([&] { set.add(path("no/c"), "three"); }),
                  path("no/c").string() + ": the folder " + path("no").string() +
                      " does not exist");
    }
    EXPECT_EQ(content("a"), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(Outputs, are_taken_back_when_one_cannot_have_its_name) {
    std::ofstream(path("a")) << "old";
    OutputSet set;
    set.add(path("a"), "one");
    set.add(path("b"), "two");
    fs::create_directory(path("folder"));
    set.add(path("folder/c"), "three");
    fs::remove_all(path("folder")); // since it was asked
    EXPECT_EQ(message_of<FileError>([&] { set.put_in_place(); }),
              path("folder/c").string() + ": cannot be replaced: No such file or directory");
    EXPECT_EQ(content("a"), "old");
    EXPECT_FALSE(fs::exists(path("b")));
}

TEST_F(Outputs, with_temporary_names_are_removed_for_a_program_that_ends) {
    const StagedFile one("a", path("a"), "one", Waiting::under_a_temporary_name);
    const StagedFile two("b", path("b"), "two", Waiting::under_a_temporary_name);
    EXPECT_EQ(files(), 2);
    remove_staged_files();
    EXPECT_EQ(files(), 0);
    remove_staged_files();
}

/// Whether the folder's file system knows files without a name.
bool knows_nameless_files(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_WRONLY | O_TMPFILE, 0666);
    if (descriptor >= 0) ::close(descriptor);
    return descriptor >= 0;
}

TEST_F(Outputs, wait_without_a_name_where_there_are_such_files) {
    OutputSet set;
    set.add(path("a"), "one");
    EXPECT_EQ(files(), knows_nameless_files(folder_) ? 0 : 1);
    set.put_in_place();
    EXPECT_EQ(files(), 1);
}

TEST_F(Outputs, have_their_names_however_they_waited) {
    for (Waiting waiting : {Waiting::nameless, Waiting::under_a_temporary_name}) {
        fs::remove(path("new"));
        std::ofstream(path("old")) << "old";
        fs::permissions(path("old"), fs::perms::owner_read);
        {
            StagedFile replacing("old", path("old"), "one", waiting);
            StagedFile created("new", path("new"), "two", waiting);
            StagedFile late("new", path("new"), "three", waiting); // when the name is taken already
            EXPECT_EQ(content("old"), "old");
            for (StagedFile* file : {&replacing, &created, &late}) file->put_in_place();
            EXPECT_EQ(content("old"), "one");
            EXPECT_EQ(content("new"), "three");
            late.take_back();
            EXPECT_EQ(content("new"), "two");
            created.take_back();
            replacing.take_back();
            EXPECT_EQ(content("old"), "old");
            replacing.put_in_place();
        }
        EXPECT_EQ(content("old"), "one");
        EXPECT_EQ(fs::status(path("old")).permissions(), fs::perms::owner_read);
        EXPECT_EQ(files(), 1);
        fs::remove(path("old"));
    }
}

TEST_F(Outputs, are_told_apart_by_inode) {
    std::ofstream(path("a.csv")) << "1 2";
    fs::create_hard_link(path("a.csv"), path("b.csv"));
    fs::create_symlink("none.csv", path("c.csv"));
    const auto check = [&](const char* output, const char* other, const char* input) {
        return message_of<InvalidInput>([&] {
            check_outputs(std::array{FileUse{path(output), "one"}, FileUse{path(other), "two"}},
                          std::array{FileUse{path(input), "the input"}});
        });
    };
    EXPECT_EQ(check("x.csv", "y.csv", "a.csv"), "nothing was thrown");
    EXPECT_EQ(check("x.csv", "b.csv", "a.csv"),
              path("b.csv").string() + ": it is the file of the input");
    EXPECT_EQ(check("none.csv", "c.csv", "a.csv"),
              path("c.csv").string() + ": it would be written twice, as one and as two");
    EXPECT_EQ(check("x.csv",
                    "./../"
                    "x.csv",
                    "missing.csv"),
              "nothing was thrown");
}

TEST_F(Outputs, hold_what_can_be_read_back) {
    PointSet points(3, 2);
    points(1, 1) = std::nan("");
    EXPECT_EQ(message_of<InvalidInput>([&] { write_points(path("p.csv"), points); }),
              "sample 1: its coordinates (0, nan) must be finite numbers");
    points(1, 1) = 0;
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  write_points(path("p.npy"), points, {2, 2});
              }),
              "grid: 2x2 needs 4 samples, got 3");
    EXPECT_EQ(message_of<InvalidInput>([&] { write_points(path("p.csv"), Points()); }),
              "samples: there are none");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  read_points(path("p.csv"), {{3, 4}, true});
              }),
              path("p.csv").string() +
                  ": a table of heights is a grid already; it is read with a grid's shape or as "
                  "heights");
    PointSet control(2, 1);
    control(1, 0) = INFINITY;
    const Spline line({KnotVector(1, {0, 0, 1, 1})}, control);
    EXPECT_EQ(message_of<InvalidInput>([&] { write_spline(path("s.json"), {.spline = line}); }),
              "spline: control point 1 is (inf); only finite numbers are written");
    const Spline good({KnotVector(1, {0, 0, 1, 1})}, PointSet(2, 1));
    EXPECT_EQ(message_of<InvalidInput>(
                  [&] { write_spline(path("s.json"), {.spline = good, .unit = "km"}); }),
              "unknown unit 'km'; did you mean 'mm'?");
    EXPECT_EQ(message_of<InvalidInput>(
                  [&] { write_spline(path("s.json"), {.spline = good, .chord_tolerance = -1}); }),
              "chord tolerance -1: must be positive and finite, or 0 for a thousandth of the size");
    const double parameter = std::nan("");
    EXPECT_EQ(message_of<InvalidInput>([&] { good(std::span(&parameter, 1)); }),
              "evaluate: parameter nan is not a finite number");
    EXPECT_EQ(message_of<InvalidInput>([&] { evaluate(good, Points(&parameter, 1, 1)); }),
              "evaluate: parameter nan is not a finite number");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  evaluate_grid(good, {{0.5, INFINITY}});
              }),
              "evaluate: parameter inf is not a finite number");
    EXPECT_EQ(files(), 0);
}

} // namespace
