#pragma once

#include <batten/core/core.hpp>

#include <filesystem>
#include <string_view>
#include <vector>

namespace batten {

/// Whether a header names every column, or leaves the first one without a name as pandas does with
/// its index.
enum class FirstColumn { like_others, unnamed };

/// Numbers of a text file in rows of one width.
struct TextTable {
    std::vector<double> values;
    Index columns = 0;
    /// Line (from 1) of each row.
    std::vector<Index> lines;
    /// Leading lines that are text: a header or a title.
    Index title_lines = 0;
    /// What the header says of the first column.
    FirstColumn first_column = FirstColumn::like_others;
    /// Trailing lines that are text (only after a title line in an airfoil file).
    Index note_lines = 0;
    /// Rows before which a blank line stands.
    std::vector<Index> blocks;

    Index rows() const { return static_cast<Index>(lines.size()); }
    double operator()(Index row, Index column) const {
        return values[static_cast<std::size_t>(row * columns + column)];
    }
};

/// Whether titles of any text and trailing notes are expected.
enum class TextLayout { table, airfoil };

/// Scans numbers separated by commas, semicolons, blanks or tabs; `#` starts a comment. The first
/// line of a table may be a header: text, or an empty field before text.
/// Throws FileError `path:line:column: ...` for text where a number belongs and `path:line: ...`
/// for a row of another width than the first.
TextTable scan_text(const std::filesystem::path& path, std::string_view text, TextLayout layout);

} // namespace batten
