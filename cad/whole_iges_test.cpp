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

TEST(WholeIges, other_texts_are_left_to_the_reader) {
    for (const char* text : {"", "\n", "not IGES", "ISO-10303-21;\nHEADER;\n"})
        EXPECT_NO_THROW(check_whole_iges("a.igs", text));
}

} // namespace
} // namespace batten::cad
