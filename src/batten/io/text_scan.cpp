#include <batten/io/text_scan.hpp>

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>

namespace batten {

namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool is_comma(char c) {
    return c == ',' || c == ';';
}

/// Splits a line; an empty field between two commas is an empty token.
void split(std::string_view line, std::vector<TextToken>& tokens) {
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

std::string_view without_comment(std::string_view line) {
    return line.substr(0, line.find('#'));
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

/// Appends a row's numbers to `values`; what is wrong with it where something is.
std::optional<std::string> take_row(const std::vector<TextToken>& tokens, Index columns,
                                    std::vector<double>& values) {
    for (const TextToken& token : tokens) {
        double value = 0;
        if (!parse(token.text, value))
            return fmt::format(":{}: '{}' is not a number", token.column, shown(token.text));
        values.push_back(value);
    }
    const auto width = static_cast<Index>(tokens.size());
    if (width == columns) return std::nullopt;
    return fmt::format(": {} number{} where the rows before have {}", width, width == 1 ? "" : "s",
                       columns);
}

bool begins_notes(const std::vector<TextToken>& tokens) {
    double value = 0;
    return !tokens.empty() && !parse(tokens[0].text, value);
}

/// The plain row at `at`, into `values` at `out`: `columns` numbers without a sign `+`, an empty
/// field or a comment among them. Returns where the next line begins; null for any other line.
const char* plain_row(const char* at, const char* end, Index columns, double* out) {
    const auto skip_blanks = [&] {
        while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    for (Index k = 0; k < columns; ++k) {
        skip_blanks();
        const auto [next, error] = std::from_chars(at, end, out[k]);
        if (error != std::errc()) return nullptr;
        at = next;
        if (at == end) return k + 1 == columns ? at : nullptr;
        if (is_comma(*at))
            ++at;
        else if (*at != '\n' && *at != ' ' && *at != '\t' && *at != '\r')
            return nullptr;
        else {
            skip_blanks();
            if (at != end && is_comma(*at)) ++at;
        }
    }
    skip_blanks();
    if (at == end) return at;
    return *at == '\n' ? at + 1 : nullptr;
}

} // namespace

void TextScanner::line(std::string_view text, Index number, std::vector<double>& values) {
    text = without_comment(text);
    split(text, tokens_);
    if (tokens_.empty()) return;
    double first = 0;
    const bool starts_with_number = parse(tokens_[0].text, first);
    if (in_notes_) return note(number, starts_with_number);
    const bool may_be_title = airfoil() || title_lines_ == 0;
    if (!starts_with_number && rows_ == 0 && may_be_title && is_title()) return title(text);
    if (!starts_with_number && rows_ > 0 && airfoil()) {
        in_notes_ = true;
        ++note_lines_;
        return;
    }
    row(number, values);
}

/// Whether a line that does not start with a number names columns. A name does not start like a
/// number, "1e400" or "1.5.2" is a number gone wrong; and an empty field is no name, unless
/// names follow.
bool TextScanner::is_title() const {
    if (airfoil()) return true;
    const std::string_view first = tokens_[0].text;
    if (first.empty())
        return tokens_.size() > 1 &&
               std::all_of(tokens_.begin() + 1, tokens_.end(), [](const TextToken& token) {
                   double value = 0;
                   return !token.text.empty() && !parse(token.text, value);
               });
    const char begin = first.front();
    return !((begin >= '0' && begin <= '9') || begin == '.' ||
             ((begin == '-' || begin == '+') && first.size() > 1));
}

void TextScanner::title(std::string_view text) {
    ++title_lines_;
    names_ = static_cast<Index>(tokens_.size());
    const std::string_view first = tokens_[0].text;
    if (first.empty() || first == "\"\"")
        first_ = Unnamed::by_comma;
    else if (text.starts_with('\t'))
        first_ = Unnamed::by_tab;
}

void TextScanner::note(Index number, bool starts_with_number) {
    double value = 0;
    bool numbers = starts_with_number && static_cast<Index>(tokens_.size()) == columns_;
    for (const TextToken& token : tokens_) numbers = numbers && parse(token.text, value);
    if (numbers)
        throw FileError(fmt::format("{}:{}: numbers after a line of text that ended the points",
                                    path_, number));
    ++note_lines_;
}

void TextScanner::row(Index number, std::vector<double>& values) {
    const auto width = static_cast<Index>(tokens_.size());
    if (rows_ == 1 && width != columns_ && airfoil()) {
        // an airfoil's first line of numbers in another width is a title ("2412") or a range
        values.clear();
        rows_ = 0;
        ++title_lines_;
    }
    if (rows_ == 0) {
        columns_ = width;
        const bool unnamed = (first_ == Unnamed::by_comma && names_ == width) ||
                             (first_ == Unnamed::by_tab && names_ + 1 == width);
        first_column_is_unnamed_ = unnamed && !airfoil() && width > 1;
    }
    if (const auto fault = take_row(tokens_, columns_, values))
        throw FileError(fmt::format("{}:{}{}", path_, number, *fault));
    ++rows_;
}

void scan_rows(std::string_view text, TextLayout layout, Index columns, TextRows& rows) {
    const auto width = static_cast<std::size_t>(columns);
    std::vector<TextToken> tokens;
    std::vector<double> row;
    std::size_t count = 0; // numbers
    rows.lines = rows.bad_line = rows.not_finite_line = 0;
    rows.rest = {};
    for (; !text.empty(); ++rows.lines) {
        if (rows.values.size() < count + width) rows.values.resize(count + width);
        double* out = rows.values.data() + count;
        const char* next = plain_row(text.data(), text.data() + text.size(), columns, out);
        std::size_t length = 0;
        if (next != nullptr) {
            length = static_cast<std::size_t>(next - text.data());
        } else {
            const std::size_t end = std::min(text.find('\n'), text.size());
            length = std::min(end + 1, text.size());
            split(without_comment(text.substr(0, end)), tokens);
            if (layout == TextLayout::airfoil && begins_notes(tokens)) {
                rows.rest = text;
                break;
            }
            row.clear();
            if (auto fault = take_row(tokens, columns, row); fault && !tokens.empty()) {
                rows.bad_line = rows.lines + 1;
                rows.fault = std::move(*fault);
                break;
            }
            std::ranges::copy(row, out);
        }
        if (next != nullptr || !tokens.empty()) {
            double probe = 0; // stays zero while all are finite
            for (std::size_t k = 0; k < width; ++k) probe += out[k] * 0.0;
            if (probe != 0 && rows.not_finite_line == 0) rows.not_finite_line = rows.lines + 1;
            count += width;
        }
        text.remove_prefix(length);
    }
    rows.values.resize(count);
}

} // namespace batten
