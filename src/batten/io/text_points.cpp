#include <batten/io/point_formats.hpp>

#include <batten/io/output_file.hpp>
#include <batten/io/text_scan.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

void append_row(std::vector<double>& values, const TextTable& table, Index row) {
    for (Index c = 0; c < table.columns; ++c) values.push_back(table(row, c));
}

/// The layout with a line of two counts, then the upper and the lower side, both from the leading
/// edge.
bool has_count_line(const TextTable& table) {
    if (table.columns != 2 || table.rows() < 5) return false;
    const double a = table(0, 0);
    const double b = table(0, 1);
    return a >= 2 && b >= 2 && a == std::floor(a) && b == std::floor(b) &&
           a + b == static_cast<double>(table.rows() - 1);
}

NumberArray join_sides(const TextTable& table) {
    NumberArray result;
    const auto upper = static_cast<Index>(table(0, 0));
    for (Index row = upper; row >= 1; --row) append_row(result.values, table, row);
    Index row = upper + 1;
    if (table(row, 0) == table(1, 0) && table(row, 1) == table(1, 1))
        ++row; // the leading edge stands in both
    for (; row < table.rows(); ++row) append_row(result.values, table, row);
    result.shape = {static_cast<Index>(result.values.size()) / 2, 2};
    result.notes.emplace_back("airfoil file in two blocks: joined into one run, upper side first, "
                              "from the trailing edge");
    return result;
}

/// Whether the first column numbers the rows: 0, 1, 2, ...
bool counts_rows(const TextTable& table) {
    for (Index row = 0; row < table.rows(); ++row)
        if (table(row, 0) != static_cast<double>(row)) return false;
    return true;
}

NumberArray without_first_column(const TextTable& table) {
    NumberArray result;
    result.values.reserve(table.values.size());
    for (Index row = 0; row < table.rows(); ++row)
        for (Index c = 1; c < table.columns; ++c) result.values.push_back(table(row, c));
    result.shape = {table.rows(), table.columns - 1};
    result.notes.emplace_back("the first column has no name and counts the rows: left out");
    return result;
}

} // namespace

NumberArray parse_text(const std::filesystem::path& path, std::string_view text) {
    const bool airfoil = extension(path) == ".dat";
    TextTable table = scan_text(path, text, airfoil ? TextLayout::airfoil : TextLayout::table);
    if (table.rows() == 0) throw FileError(fmt::format("{}: no points in the file", path.string()));
    NumberArray result;
    if (airfoil && has_count_line(table)) {
        result = join_sides(table);
    } else if (table.first_column == FirstColumn::unnamed && counts_rows(table)) {
        result = without_first_column(table);
    } else {
        result.shape = {table.rows(), table.columns};
        result.values = std::move(table.values);
    }
    if (table.first_column == FirstColumn::unnamed && result.notes.empty())
        result.notes.emplace_back(
            "the first column has no name but does not count the rows: read as "
            "a coordinate");
    if (table.note_lines > 0)
        result.notes.push_back(fmt::format("{} line{} of text after the points left out",
                                           table.note_lines, table.note_lines == 1 ? "" : "s"));
    return result;
}

std::string format_text(const Points& points, char separator) {
    fmt::memory_buffer out;
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < points.dim(); ++d)
            fmt::format_to(std::back_inserter(out), "{}{}", points(i, d),
                           d + 1 < points.dim() ? separator : '\n');
    return fmt::to_string(out);
}

} // namespace batten
