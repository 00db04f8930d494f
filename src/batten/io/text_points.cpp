#include <batten/io/point_formats.hpp>

#include <batten/core/threads.hpp>
#include <batten/io/text_reader.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// Numbers in rows of one width.
struct Table {
    const LargeArray& values;
    std::size_t columns;

    std::size_t rows() const { return values.size() / columns; }
    double operator()(std::size_t row, std::size_t column) const {
        return values[row * columns + column];
    }
};

/// The layout with a line of two counts, then the upper and the lower side, both from the leading
/// edge.
bool has_count_line(const Table& table) {
    if (table.columns != 2 || table.rows() < 5) return false;
    const double a = table(0, 0);
    const double b = table(0, 1);
    return a >= 2 && b >= 2 && a == std::floor(a) && b == std::floor(b) &&
           a + b == static_cast<double>(table.rows() - 1);
}

LargeArray joined_sides(const Table& table) {
    const auto upper = static_cast<std::size_t>(table(0, 0));
    // the leading edge may stand in both
    const bool twice = table(upper + 1, 0) == table(1, 0) && table(upper + 1, 1) == table(1, 1);
    LargeArray joined(table.values.size() - (twice ? 4 : 2));
    double* out = joined.data();
    const auto append = [&](std::size_t row) {
        *out++ = table(row, 0);
        *out++ = table(row, 1);
    };
    for (std::size_t row = upper; row >= 1; --row) append(row);
    for (std::size_t row = upper + (twice ? 2 : 1); row < table.rows(); ++row) append(row);
    return joined;
}

/// Whether the first column numbers the rows: 0, 1, 2, ...
bool counts_rows(const Table& table) {
    for (std::size_t row = 0; row < table.rows(); ++row)
        if (table(row, 0) != static_cast<double>(row)) return false;
    return true;
}

/// The numbers close up in their place.
void leave_out_first_column(LargeArray& values, std::size_t columns) {
    const std::size_t rows = values.size() / columns;
    double* out = values.data();
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t c = 1; c < columns; ++c) *out++ = values[row * columns + c];
    values.resize(rows * (columns - 1));
}

constexpr const char* left_out_note = "the first column has no name and counts the rows: left out";
constexpr const char* kept_note = "the first column has no name but does not count the rows: read "
                                  "as a coordinate";

/// Whether the first column numbers the rows that a reader has from its beginning.
bool counts_rows(NumberReader& reader) {
    const auto columns = static_cast<std::size_t>(reader.shape()[1]);
    LargeArray part(columns * std::max<std::size_t>(1, (std::size_t{1} << 16U) / columns));
    std::size_t at = 0; // number
    while (const std::size_t got = reader.read({part.data(), part.size()})) {
        for (std::size_t k = (columns - at % columns) % columns; k < got; k += columns)
            if (part[k] != static_cast<double>((at + k) / columns)) return false;
        at += got;
    }
    return true;
}

/// A text whose first column may be left out.
class UnnamedColumn final : public NumberReader {
  public:
    explicit UnnamedColumn(std::unique_ptr<NumberReader> text)
        : text_(std::move(text)), is_left_out_(counts_rows(*text_)) {
        text_->rewind();
    }

    std::vector<Index> shape() const override {
        std::vector<Index> shape = text_->shape();
        if (is_left_out_) --shape[1];
        return shape;
    }
    std::size_t read(std::span<double> into) override {
        if (!is_left_out_) return text_->read(into);
        std::size_t done = 0;
        while (done < into.size()) {
            const std::size_t columns = static_cast<std::size_t>(text_->shape()[1]);
            double first = 0;
            if (at_ % columns == 0) at_ += text_->read({&first, 1});
            const std::size_t wanted = std::min(columns - at_ % columns, into.size() - done);
            const std::size_t got = text_->read(into.subspan(done, wanted));
            if (got == 0) break;
            at_ += got;
            done += got;
        }
        return done;
    }
    void rewind() override {
        text_->rewind();
        at_ = 0;
    }
    std::vector<std::string> notes() const override {
        std::vector<std::string> notes = text_->notes();
        notes.insert(notes.begin(), is_left_out_ ? left_out_note : kept_note);
        return notes;
    }
    std::uint64_t bytes_read() const override { return text_->bytes_read(); }
    std::string path() const override { return text_->path(); }
    std::string not_finite_place() const override { return text_->not_finite_place(); }

  private:
    std::unique_ptr<NumberReader> text_;
    bool is_left_out_;
    std::size_t at_ = 0; ///< numbers of the text taken
};

} // namespace

bool TextReader::may_have_blocks() const {
    const std::span<const double> first = ready_.empty() ? std::span<const double>() : ready_[0];
    return is_airfoil() && scanner_.columns() == 2 && first.size() >= 2 && first[0] >= 2 &&
           first[1] >= 2 && first[0] == std::floor(first[0]) && first[1] == std::floor(first[1]);
}

NumberArray TextReader::all() {
    NumberArray result;
    rewind();
    for (; !ready_.empty(); advance()) {
        is_fresh_ = false;
        std::vector<std::size_t> begins{result.values.size()};
        for (const auto& part : ready_) begins.push_back(begins.back() + part.size());
        make_room(result.values, begins.back() - begins.front());
        result.values.resize(begins.back());
        for_each_chunk(static_cast<Index>(ready_.size()), [&](Index k) {
            const auto at = static_cast<std::size_t>(k);
            std::ranges::copy(ready_[at], result.values.data() + begins[at]);
        });
    }
    const auto columns = static_cast<std::size_t>(scanner_.columns());
    const Table table{result.values, columns};
    result.shape = {static_cast<Index>(table.rows()), scanner_.columns()};
    if (is_airfoil() && has_count_line(table)) {
        result.values = joined_sides(table);
        result.shape[0] = static_cast<Index>(result.values.size() / 2);
        result.notes.emplace_back("airfoil file in two blocks: joined into one run, upper side "
                                  "first, from the trailing edge");
    } else if (first_column_is_unnamed()) {
        const bool counts = counts_rows(table);
        result.notes.emplace_back(counts ? left_out_note : kept_note);
        if (counts) {
            leave_out_first_column(result.values, columns);
            --result.shape[1];
        }
    }
    for (std::string& note : notes()) result.notes.push_back(std::move(note));
    return result;
}

std::unique_ptr<NumberReader> open_text(const std::filesystem::path& path,
                                        std::unique_ptr<ByteSource> bytes) {
    return std::make_unique<TextReader>(path, std::move(bytes));
}

std::unique_ptr<NumberReader> open_text_for_passes(const std::filesystem::path& path,
                                                   std::unique_ptr<ByteSource> bytes) {
    auto text = std::make_unique<TextReader>(path, std::move(bytes));
    if (text->may_have_blocks()) return std::make_unique<HeldNumbers>(path.string(), text->all());
    if (text->first_column_is_unnamed()) return std::make_unique<UnnamedColumn>(std::move(text));
    return text;
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
