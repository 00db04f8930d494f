#include <batten/io/text_reader.hpp>

#include <batten/core/counts.hpp>
#include <batten/core/errors.hpp>
#include <batten/core/threads.hpp>
#include <batten/io/output_file.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace batten {

namespace {

TextLayout layout_of(const std::filesystem::path& path) {
    return inner_extension(path) == ".dat" ? TextLayout::airfoil : TextLayout::table;
}

} // namespace

TextReader::TextReader(const std::filesystem::path& path, std::unique_ptr<ByteSource> bytes,
                       const TextParts& parts)
    : path_(path),
      bytes_(std::move(bytes)),
      parts_(parts),
      layout_(layout_of(path)),
      scanner_(path.string(), layout_) {
    restart();
    if (bytes_read_ == 0) throw FileError(fmt::format("{}: the file is empty", path_.string()));
    if (scanner_.columns() == 0)
        throw FileError(fmt::format("{}: no points in the file", path_.string()));
}

void TextReader::rewind() {
    if (is_fresh_) return;
    bytes_->seek(0);
    restart();
}

void TextReader::restart() {
    scanner_ = TextScanner(path_.string(), layout_);
    carried_ = {};
    bytes_read_ = 0;
    at_end_ = false;
    lines_ = not_finite_line_ = 0;
    head_.clear();
    ready_.clear();
    next_part_ = given_ = numbers_ = 0;
    advance();
    is_fresh_ = true;
}

std::size_t TextReader::read(std::span<double> into) {
    is_fresh_ = false;
    std::size_t done = 0;
    while (done < into.size()) {
        if (next_part_ == ready_.size()) {
            advance();
            if (ready_.empty()) break;
        }
        const std::span<const double> part = ready_[next_part_].subspan(given_);
        const std::size_t count = std::min(part.size(), into.size() - done);
        std::copy_n(part.begin(), count, into.begin() + static_cast<std::ptrdiff_t>(done));
        done += count;
        given_ += count;
        if (count < part.size()) break;
        ++next_part_;
        given_ = 0;
    }
    numbers_ += done;
    if (done == 0 && !into.empty()) rows_ = static_cast<Index>(numbers_) / scanner_.columns();
    return done;
}

std::vector<std::string> TextReader::notes() const {
    std::vector<std::string> notes;
    if (const Index count = scanner_.note_lines(); count > 0)
        notes.push_back(fmt::format("{} line{} of text after the points left out", count,
                                    count == 1 ? "" : "s"));
    if (std::string note = bytes_->note(); !note.empty()) notes.push_back(std::move(note));
    return notes;
}

std::string TextReader::not_finite_place() const {
    return not_finite_line_ > 0 ? fmt::format("{}:{}", path_.string(), not_finite_line_)
                                : path_.string();
}

/// The next rows, none at the end.
void TextReader::advance() {
    ready_.clear();
    next_part_ = given_ = 0;
    if (scanner_.is_settled() || scanner_.is_in_notes()) head_.clear(); // handed out
    while (ready_.empty() && !at_end_) {
        std::string_view text = take_lines(fill());
        // the first rows may yet turn out to be titles
        const bool settled = scanner_.is_settled();
        if (!head_.empty() && (settled || scanner_.is_in_notes() || at_end_))
            ready_.emplace_back(head_);
        if (settled) take_rows(text);
    }
}

/// Whole lines that follow, the last perhaps without an end.
std::string_view TextReader::fill() {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    constexpr std::size_t shortest = 16; // the mark is read at once
    char* begin = nullptr;
    std::size_t there = carried_.size();
    for (std::size_t room = std::max({parts_.window, shortest, 2 * there});; room *= 2) {
        const std::size_t doubles = room / sizeof(double) + 1;
        if (buffer_.capacity() < doubles)
            check_memory(static_cast<Index>(doubles), input_name(path_));
        const std::ptrdiff_t place =
            there > 0 ? carried_.data() - reinterpret_cast<const char*>(buffer_.data()) : 0;
        buffer_.resize(std::max(doubles, buffer_.size()));
        begin = reinterpret_cast<char*>(buffer_.data());
        if (place > 0) std::memmove(begin, begin + place, there);
        const std::size_t count = bytes_->read({begin + there, room - there});
        at_end_ = count < room - there;
        const bool first = bytes_read_ == 0;
        bytes_read_ += count;
        there += count;
        if (first && std::string_view(begin, there).starts_with(byte_order_mark)) {
            there -= byte_order_mark.size();
            std::memmove(begin, begin + byte_order_mark.size(), there);
        }
        const std::string_view text(begin, there);
        const std::size_t whole = at_end_ ? there : text.rfind('\n') + 1;
        carried_ = text.substr(whole);
        if (whole > 0 || at_end_) return text.substr(0, whole);
    }
}

void TextReader::take_line(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    scanner_.line(text.substr(0, end), ++lines_, head_);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (scanner_.is_in_notes()) return;
    if (std::ranges::all_of(head_, [](double x) { return std::isfinite(x); }))
        not_finite_line_ = 0;
    else if (not_finite_line_ == 0)
        not_finite_line_ = lines_;
}

/// Takes line by line until all lines that follow are rows; what is left of the text.
std::string_view TextReader::take_lines(std::string_view text) {
    while (!text.empty() && !scanner_.is_settled()) take_line(text);
    return text;
}

std::vector<std::string_view> TextReader::cut(std::string_view text) const {
    std::vector<std::string_view> pieces;
    while (!text.empty()) {
        const std::size_t end = text.find('\n', std::min(parts_.block, text.size()) - 1);
        pieces.push_back(text.substr(0, end == std::string_view::npos ? end : end + 1));
        text.remove_prefix(pieces.back().size());
    }
    return pieces;
}

void TextReader::take_rows(std::string_view text) {
    const std::vector<std::string_view> pieces = cut(text);
    if (blocks_.size() < pieces.size()) blocks_.resize(pieces.size());
    for_each_chunk(static_cast<Index>(pieces.size()), [&](Index k) {
        const auto at = static_cast<std::size_t>(k);
        scan_rows(pieces[at], layout_, scanner_.columns(), blocks_[at]);
    });
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        const TextRows& rows = blocks_[k];
        if (rows.bad_line > 0)
            throw FileError(
                fmt::format("{}:{}{}", path_.string(), lines_ + rows.bad_line, rows.fault));
        if (not_finite_line_ == 0 && rows.not_finite_line > 0)
            not_finite_line_ = lines_ + rows.not_finite_line;
        if (!rows.values.empty()) ready_.push_back(rows.values.values());
        lines_ += rows.lines;
        if (rows.rest.empty()) continue;
        text.remove_prefix(static_cast<std::size_t>(rows.rest.data() - text.data()));
        take_line(text); // the first of an airfoil's notes
        take_lines(text);
        return;
    }
}

/// So that numbers which are ready can be appended: at first for as many as the file may have.
void TextReader::make_room(LargeArray& values, std::size_t ready) const {
    const std::size_t needed = values.size() + ready;
    if (needed <= values.capacity()) return;
    std::size_t room = 2 * needed;
    if (bytes_->size() >= 0 && values.empty()) {
        const double taken = static_cast<double>(bytes_read_ - carried_.size());
        const double expected =
            static_cast<double>(ready) / taken * static_cast<double>(bytes_->size());
        room = std::max(needed, static_cast<std::size_t>(1.02 * expected));
    }
    check_memory(static_cast<Index>(room), input_name(path_));
    values.reserve(room);
}

} // namespace batten
