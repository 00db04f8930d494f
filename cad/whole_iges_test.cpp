// An IGES text without its terminate section is refused, with line ends of every kind or none.
#include "whole_iges.hpp"

#include <batten/core/core.hpp>

#include <gtest/gtest.h>

namespace batten::cad {
namespace {

/// A record of 80 characters: text, the section's letter, the number.
std::string record(std::string text, char letter, const std::string& number) {
    text.resize(72, ' ');
    return text + letter + std::string(7 - number.size(), ' ') + number;
}

std::vector<std::string> records() {
    return {record("", 'S', "1"), record("1H,,1H;,4HSLOT;", 'G', "1"),
            record("     116       1", 'D', "1"), record("116,1.,2.,3.;", 'P', "1"),
            record("S      1G      1D      1P      1", 'T', "1")};
}

std::string joined(const std::vector<std::string>& lines, const std::string& end) {
    std::string text;
    for (const std::string& line : lines) text += line + end;
    return text;
}

TEST(WholeIges, whole_files_pass) {
    for (const char* end : {"\n", "\r\n", ""})
        EXPECT_NO_THROW(check_whole_iges("a.igs", joined(records(), end)));
    std::vector<std::string> more = records();
    more.emplace_back("a note that some program left");
    EXPECT_NO_THROW(check_whole_iges("a.igs", joined(more, "\n")));
}

TEST(WholeIges, every_prefix_beyond_the_first_record_is_refused) {
    for (const char* end : {"\n", "\r\n", ""}) {
        std::string text = joined(records(), end);
        text.resize(text.size() - std::string_view(end).size());
        for (std::size_t size = 80; size < text.size(); ++size)
            EXPECT_THROW(check_whole_iges("a.igs", text.substr(0, size)), FileError) << size;
    }
}

/// A straight line as a B-spline curve of degree 1.
std::vector<std::string> line() {
    return {record("", 'S', "1"),
            record("1H,,1H;,4HSLOT;", 'G', "1"),
            record("     126       1", 'D', "1"),
            record("     126       0       0       2", 'D', "2"),
            record("126,1,1,1,0,1,0,0.,0.,1.,1.,1.,1.,0.,0.,0.,", 'P', "1"),
            record("1.D0,2.,+3.E-1,0.,1.,0.,0.,1.;", 'P', "2"),
            record("S      1G      1D      2P      2", 'T', "1")};
}

std::string refusal(const std::vector<std::string>& lines) {
    try {
        check_whole_iges("a.igs", joined(lines, "\n"));
    } catch (const FileError& error) {
        return error.what();
    }
    return {};
}

TEST(WholeIges, a_missing_or_changed_record_is_named) {
    EXPECT_EQ(refusal(line()), "");
    for (std::size_t k = 1; k < line().size(); ++k) {
        std::vector<std::string> less = line();
        less.erase(less.begin() + static_cast<std::ptrdiff_t>(k));
        EXPECT_NE(refusal(less), "") << k;
    }
    std::vector<std::string> lines = line();
    lines.erase(lines.begin() + 4);
    EXPECT_EQ(refusal(lines), "a.igs: the file is damaged: behind record 0 of section P stands "
                              "record 2");
    lines = line();
    lines.erase(lines.begin() + 5);
    EXPECT_EQ(refusal(lines), "a.igs: the file is damaged: section P has 1 records, its terminate "
                              "section counts 2");
    lines = line();
    lines[5] = record("1.D0,2.;", 'P', "2");
    EXPECT_EQ(refusal(lines), "a.igs: the file is damaged: numbers are missing in the B-spline of "
                              "directory record 1");
    lines[5] = record("1.D0,2.,,0.,1.,0.,0.,1.;", 'P', "2");
    EXPECT_EQ(refusal(lines), ""); // a default
    lines[5] = record("1.D0,2.5  5,1.,0.,1.,0.,0.,1.;", 'P', "2");
    EXPECT_EQ(refusal(lines), "a.igs: the file is damaged: '2.5  5' stands for a number in the "
                              "B-spline of directory record 1");
    lines[5] = record("1.D0,2.,x,0.,1.,0.,0.,1.;", 'P', "2");
    EXPECT_EQ(refusal(lines), "a.igs: the file is damaged: 'x' stands for a number in the B-spline "
                              "of directory record 1");
    lines = line();
    lines[4] = record("126,1,9,1,0,1,0,0.,0.,1.,1.,1.,1.,0.,0.,0.,", 'P', "1");
    EXPECT_NE(refusal(lines), "");
}

TEST(WholeIges, other_texts_are_left_to_the_reader) {
    for (const char* text : {"", "\n", "not IGES", "ISO-10303-21;\nHEADER;\n"})
        EXPECT_NO_THROW(check_whole_iges("a.igs", text));
}

} // namespace
} // namespace batten::cad
