#include "whole_iges.hpp"

#include <batten/core/core.hpp>

#include <array>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

namespace batten::cad {

namespace {

constexpr std::size_t record_length = 80;
constexpr std::size_t letter_at = 72; // the section's letter; the record's number follows
constexpr std::size_t field_length = 8;
constexpr std::size_t parameter_columns = 64; // of a record; the entity's number follows
constexpr std::string_view sections = "SGDP";

std::string_view without_blanks_around(std::string_view text) {
    const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
    text.remove_prefix(first);
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

/// The number that stands alone between spaces.
std::optional<Index> whole_number(std::string_view text) {
    text = without_blanks_around(text);
    if (text.empty()) return std::nullopt;
    Index value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// The record's number, where it belongs to the section.
std::optional<Index> number_in(std::string_view record, char letter) {
    if (record.size() <= letter_at || record[letter_at] != letter) return std::nullopt;
    const auto number = whole_number(record.substr(letter_at + 1, record_length - letter_at - 1));
    return number && *number > 0 ? number : std::nullopt; // no digit of it is cut off
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

using Records = std::vector<std::string_view>;

/// The records of a file by section, in the order of `sections`; each is complete.
std::array<Records, 4> records_of(const std::filesystem::path& path, std::string_view content) {
    std::array<Records, 4> records;
    while (!content.empty()) {
        const std::string_view record = next_record(content);
        if (number_in(record, 'T')) {
            for (std::size_t k = 0; k < sections.size(); ++k) {
                const auto stated = whole_number(record.substr(k * field_length + 1, 7));
                if (stated && *stated != std::ssize(records[k]))
                    throw FileError(fmt::format("{}: the file is damaged: section {} has {} records"
                                                ", its terminate section counts {}",
                                                path.string(), sections[k], records[k].size(),
                                                *stated));
            }
            return records;
        }
        for (std::size_t k = 0; k < sections.size(); ++k) {
            const auto number = number_in(record, sections[k]);
            if (!number) continue;
            if (*number != std::ssize(records[k]) + 1)
                throw FileError(fmt::format("{}: the file is damaged: behind record {} of section "
                                            "{} stands record {}",
                                            path.string(), records[k].size(), sections[k],
                                            *number));
            records[k].push_back(record);
        }
    }
    throw FileError(path.string() + ": the file is cut off: its terminate section is missing");
}

/// What ends a parameter and what ends all of an entity.
struct Delimiters {
    char parameter = ',';
    char record = ';';
};

/// As the global section begins: 1H,,1H;, or nothing for these two.
Delimiters delimiters_of(const Records& global) {
    Delimiters result;
    if (global.empty()) return result;
    std::string_view text = global.front();
    if (text.starts_with("1H") && text.size() > 4) {
        result.parameter = text[2];
        text.remove_prefix(3);
    }
    if (text.size() > 4 && text.substr(1).starts_with("1H")) result.record = text[3];
    return result;
}

/// The parameters of an entity, as text; a blank within a number is damage.
std::vector<std::string> parameters_of(const Records& lines, Index first, Index count,
                                       Delimiters delimiters) {
    std::vector<std::string> result(1);
    for (Index k = first; k < first + count && k <= std::ssize(lines); ++k)
        for (char c : lines[static_cast<std::size_t>(k - 1)].substr(0, parameter_columns)) {
            if (c != delimiters.record && c != delimiters.parameter) {
                result.back() += c;
                continue;
            }
            result.back() = without_blanks_around(result.back());
            if (c == delimiters.record) return result;
            result.emplace_back();
        }
    return {}; // it does not end
}

/// How many numbers a B-spline curve (126) or surface (128) has up to its last control point; none
/// for other entities, or where the numbers that say so are damaged.
std::optional<std::size_t> needed(const std::vector<std::string>& parameters) {
    const auto at = [&](std::size_t k) {
        return k < parameters.size() ? whole_number(parameters[k]) : std::nullopt;
    };
    const bool surface = at(0) == 128;
    if (!surface && at(0) != 126) return std::nullopt;
    const std::size_t axes = surface ? 2 : 1;
    Index poles = 1;
    Index knots = 0;
    for (std::size_t k = 1; k <= axes; ++k) {
        const auto last = at(k);
        const auto degree = at(k + axes);
        constexpr Index most = 1 << 20;
        if (!last || !degree || *last < 0 || *degree < 0 || *last > most || *degree > most)
            return std::nullopt;
        poles *= *last + 1;
        knots += *last + *degree + 2;
    }
    const std::size_t flags = surface ? 5 : 4;
    return 1 + 2 * axes + flags + static_cast<std::size_t>(knots + 4 * poles);
}

bool is_number(std::string text) {
    for (char& c : text)
        if (c == 'D' || c == 'd') c = 'E';
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    double value = 0;
    const auto result = std::from_chars(begin, end, value);
    return result.ptr == end && begin != end && result.ec != std::errc::invalid_argument;
}

/// The B-splines have all their numbers.
void check_splines(const std::filesystem::path& path, const std::array<Records, 4>& records) {
    const Records& directory = records[2];
    const Delimiters delimiters = delimiters_of(records[1]);
    for (std::size_t k = 0; k + 1 < directory.size(); k += 2) {
        const auto first = whole_number(directory[k].substr(field_length, field_length));
        const auto count = whole_number(directory[k + 1].substr(3 * field_length, field_length));
        const auto type = whole_number(directory[k].substr(0, field_length));
        if (!first || !count || *first < 1 || (type != 126 && type != 128)) continue;
        const std::vector<std::string> parameters =
            parameters_of(records[3], *first, *count, delimiters);
        const auto wanted = needed(parameters);
        const auto damaged = [&](std::string_view what) {
            return FileError(fmt::format("{}: the file is damaged: {} in the B-spline of directory "
                                         "record {}",
                                         path.string(), what, k + 1));
        };
        if (!wanted || parameters.size() < *wanted) throw damaged("numbers are missing");
        for (std::size_t i = 0; i < *wanted; ++i)
            if (!parameters[i].empty() && !is_number(parameters[i])) // an empty one is the default
                throw damaged(fmt::format("'{}' stands for a number", parameters[i]));
    }
}

} // namespace

void check_whole_iges(const std::filesystem::path& path, std::string_view content) {
    std::string_view rest = content;
    if (!number_in(next_record(rest), 'S')) return;
    check_splines(path, records_of(path, content));
}

} // namespace batten::cad
