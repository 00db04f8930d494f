#pragma once

#include <batten/core/core.hpp>
#include <batten/core/large_array.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// Whether titles of any text and trailing notes are expected.
enum class TextLayout { table, airfoil };

/// A field of a line.
struct TextToken {
    std::string_view text;
    Index column; ///< from 1, in the line
};

/// Numbers of a text, line after line, by all its rules: commas, semicolons, blanks or tabs
/// between them, `#` before a comment, a header or titles first, an airfoil's notes last.
class TextScanner {
  public:
    /// `path` is for messages.
    TextScanner(std::string path, TextLayout layout) : path_(std::move(path)), layout_(layout) {}

    /// Takes line `number` (from 1); a row's numbers are appended to `values`, which holds the
    /// rows before as long as there are at most one.
    /// Throws FileError `path:line:column: ...` for text where a number belongs and `path:line:
    /// ...` for a row of another width than the first.
    void line(std::string_view text, Index number, std::vector<double>& values);

    /// Whether every line from now on is a row, empty or a fault, or begins an airfoil's notes.
    bool is_settled() const { return !in_notes_ && rows_ >= (airfoil() ? 2 : 1); }
    /// Whether an airfoil's points have ended.
    bool is_in_notes() const { return in_notes_; }
    /// Numbers of a row; 0 before the first.
    Index columns() const { return columns_; }
    /// Whether a header leaves the first column without a name, as pandas does with its index.
    bool first_column_is_unnamed() const { return first_column_is_unnamed_; }
    /// Trailing lines that are text (only of an airfoil).
    Index note_lines() const { return note_lines_; }

  private:
    /// How a header leaves its first column without a name: an empty field, or a tab at the front.
    enum class Unnamed { no, by_comma, by_tab };

    bool airfoil() const { return layout_ == TextLayout::airfoil; }
    bool is_title() const;
    void title(std::string_view text);
    void note(Index number, bool starts_with_number);
    void row(Index number, std::vector<double>& values);

    std::string path_;
    TextLayout layout_;
    std::vector<TextToken> tokens_;
    Index columns_ = 0;
    Index rows_ = 0;
    Index title_lines_ = 0;
    Index note_lines_ = 0;
    Index names_ = 0;
    Unnamed first_ = Unnamed::no;
    bool first_column_is_unnamed_ = false;
    bool in_notes_ = false;
};

/// Rows of a part of a text that begins and ends between lines.
struct TextRows {
    LargeArray values;
    Index lines = 0;
    /// Where an airfoil's notes begin: what was not taken, its first line after `lines` others.
    std::string_view rest{};
    /// The line (of this part, from 1) that is no row, and what is wrong with it: `:column: ...`.
    Index bad_line = 0;
    std::string fault{};
    /// The first line (of this part, from 1) with a number that is not finite; 0: none.
    Index not_finite_line = 0;
};

/// Takes the rows of `columns` numbers each out of `text`, whose scanner is settled, into `rows`,
/// whose room is used again: by the rules of TextScanner, and as fast as numbers can be read.
void scan_rows(std::string_view text, TextLayout layout, Index columns, TextRows& rows);

} // namespace batten
