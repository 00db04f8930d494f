#include <batten/io/text_scan.hpp>

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace batten {

namespace {

struct Token {
    std::string_view text;
    Index column; // from 1, in the line
};

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool is_comma(char c) {
    return c == ',' || c == ';';
}

/// Splits a line; an empty field between two commas is an empty token.
void split(std::string_view line, std::vector<Token>& tokens) {
    tokens.clear();
    std::size_t k = 0;
    bool after_comma = false;
    while (true) {
        while (k < line.size() && is_blank(line[k])) ++k;
        if (k == line.size()) break;
        if (is_comma(line[k])) {
            if (after_comma || tokens.empty()) tokens.push_back({{}, static_cast<Index>(k) + 1});
            after_comma = true;
            ++k;
            continue;
        }
        const std::size_t begin = k;
        while (k < line.size() && !is_blank(line[k]) && !is_comma(line[k])) ++k;
        tokens.push_back({line.substr(begin, k - begin), static_cast<Index>(begin) + 1});
        after_comma = false;
    }
}

bool parse(std::string_view text, double& value) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+')
        text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

std::string shown(std::string_view text) {
    std::string result;
    for (char c : text.substr(0, 40)) result += static_cast<unsigned char>(c) < 32 ? '?' : c;
    return result;
}

/// Reads line after line into a table.
class Scanner {
  public:
    Scanner(const std::filesystem::path& path, TextLayout layout) : path_(path), layout_(layout) {}

    void line(std::string_view text, Index number) {
        text = text.substr(0, text.find('#'));
        split(text, tokens_);
        if (tokens_.empty()) {
            blank_ = table_.rows() > 0;
            return;
        }
        double first = 0;
        const bool starts_with_number = parse(tokens_[0].text, first);
        if (in_notes_) return check_note(number, starts_with_number);
        if (!starts_with_number && table_.rows() == 0 && may_be_title() && is_title()) {
            title(text);
            return;
        }
        if (!starts_with_number && table_.rows() > 0 && layout_ == TextLayout::airfoil) {
            in_notes_ = true;
            ++table_.note_lines;
            return;
        }
        row(number);
    }

    TextTable take() { return std::move(table_); }

  private:
    /// How a header leaves its first column without a name: an empty field, or a tab at the front.
    enum class Unnamed { no, by_comma, by_tab };

    bool may_be_title() const { return layout_ == TextLayout::airfoil || table_.title_lines == 0; }

    /// Whether a line that does not start with a number names columns. A name does not start like a
    /// number, "1e400" or "1.5.2" is a number gone wrong; and an empty field is no name, unless
    /// names follow.
    bool is_title() const {
        if (layout_ == TextLayout::airfoil) return true;
        const std::string_view first = tokens_[0].text;
        if (first.empty())
            return tokens_.size() > 1 &&
                   std::all_of(tokens_.begin() + 1, tokens_.end(), [](const Token& token) {
                       double value = 0;
                       return !token.text.empty() && !parse(token.text, value);
                   });
        const char begin = first.front();
        return !((begin >= '0' && begin <= '9') || begin == '.' ||
                 ((begin == '-' || begin == '+') && first.size() > 1));
    }

    void title(std::string_view text) {
        ++table_.title_lines;
        names_ = static_cast<Index>(tokens_.size());
        const std::string_view first = tokens_[0].text;
        if (first.empty() || first == "\"\"")
            first_ = Unnamed::by_comma;
        else if (text.starts_with('\t'))
            first_ = Unnamed::by_tab;
    }

    void check_note(Index number, bool starts_with_number) {
        double value = 0;
        bool numbers = starts_with_number && static_cast<Index>(tokens_.size()) == table_.columns;
        for (const Token& token : tokens_) numbers = numbers && parse(token.text, value);
        if (numbers)
            throw FileError(fmt::format("{}:{}: numbers after a line of text that ended the points",
                                        path_.string(), number));
        ++table_.note_lines;
    }

    void row(Index number) {
        const auto width = static_cast<Index>(tokens_.size());
        if (table_.rows() == 1 && width != table_.columns && layout_ == TextLayout::airfoil)
            drop_first_row();
        if (table_.rows() == 0) start_rows(width);
        const std::size_t size_before = table_.values.size();
        for (const Token& token : tokens_) {
            double value = 0;
            if (!parse(token.text, value)) {
                table_.values.resize(size_before);
                throw FileError(fmt::format("{}:{}:{}: '{}' is not a number", path_.string(),
                                            number, token.column, shown(token.text)));
            }
            table_.values.push_back(value);
        }
        if (width != table_.columns)
            throw FileError(fmt::format("{}:{}: {} number{} where the rows before have {}",
                                        path_.string(), number, width, width == 1 ? "" : "s",
                                        table_.columns));
        if (blank_) table_.blocks.push_back(table_.rows());
        blank_ = false;
        table_.lines.push_back(number);
    }

    void start_rows(Index width) {
        table_.columns = width;
        const bool unnamed = (first_ == Unnamed::by_comma && names_ == width) ||
                             (first_ == Unnamed::by_tab && names_ + 1 == width);
        if (unnamed && layout_ == TextLayout::table && width > 1)
            table_.first_column = FirstColumn::unnamed;
    }

    /// An airfoil's first line of numbers in another width is a title ("2412") or a plotting range.
    void drop_first_row() {
        table_.values.clear();
        table_.lines.clear();
        table_.blocks.clear();
        ++table_.title_lines;
    }

    const std::filesystem::path& path_;
    TextLayout layout_;
    TextTable table_;
    std::vector<Token> tokens_;
    Index names_ = 0;
    Unnamed first_ = Unnamed::no;
    bool blank_ = false;
    bool in_notes_ = false;
};

} // namespace

TextTable scan_text(const std::filesystem::path& path, std::string_view text, TextLayout layout) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    Scanner scanner(path, layout);
    Index number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        scanner.line(text.substr(0, end), ++number);
        if (end == std::string_view::npos) break;
        text.remove_prefix(end + 1);
    }
    return scanner.take();
}

} // namespace batten
