#include "whole_iges.hpp"

#include <batten/core/core.hpp>

namespace batten::cad {

namespace {

constexpr std::size_t record_length = 80;
constexpr std::size_t letter_at = 72; // the section's letter; the record's number follows

bool is_record(std::string_view record, char letter) {
    return record.size() > letter_at && record[letter_at] == letter &&
           record.substr(letter_at + 1, record_length - letter_at - 1).find_first_of("123456789") !=
               std::string_view::npos;
}

/// The record at the front, which goes; line ends may be missing.
std::string_view next_record(std::string_view& content) {
    const std::string_view record =
        content.substr(0, std::min(content.find_first_of("\r\n"), record_length));
    content.remove_prefix(record.size());
    const std::size_t next = content.find_first_not_of("\r\n");
    content.remove_prefix(std::min(next, content.size()));
    return record;
}

} // namespace

void check_whole_iges(const std::filesystem::path& path, std::string_view content) {
    if (!is_record(next_record(content), 'S')) return;
    while (!content.empty())
        if (is_record(next_record(content), 'T')) return;
    throw FileError(path.string() + ": the file is cut off: its terminate section is missing");
}

} // namespace batten::cad
