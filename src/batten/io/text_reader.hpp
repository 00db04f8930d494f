#pragma once

#include <batten/io/byte_source.hpp>
#include <batten/io/number_reader.hpp>
#include <batten/io/text_scan.hpp>

#include <memory>
#include <vector>

namespace batten {

/// Bytes of a text that are read at a time, and of these that a thread takes at a time; a line that
/// is longer gets a longer part.
struct TextParts {
    std::size_t window = std::size_t{1} << 21U;
    std::size_t block = std::size_t{1} << 16U;
};

/// Numbers of a text: what comes into one buffer is cut at line ends into blocks, whose rows are
/// read by all threads and handed out in order. The parts change no number and no message.
class TextReader final : public NumberReader {
  public:
    TextReader(const std::filesystem::path& path, std::unique_ptr<ByteSource> bytes,
               const TextParts& parts = {});

    std::vector<Index> shape() const override { return {rows_, scanner_.columns()}; }
    std::size_t read(std::span<double> into) override;
    void rewind() override;
    std::vector<std::string> notes() const override;
    std::uint64_t bytes_read() const override { return bytes_->bytes_read(); }
    std::string path() const override { return path_.string(); }
    std::string not_finite_place() const override;
    /// Beside all numbers what they show as a whole: two blocks of an airfoil are joined, a column
    /// without a name that counts the rows is left out.
    NumberArray all() override;

    /// Whether the first column has no name, so that only all rows tell whether it counts them.
    bool first_column_is_unnamed() const { return scanner_.first_column_is_unnamed(); }
    /// Whether the first row may be the line of two counts of an airfoil's blocks.
    bool may_have_blocks() const;

  private:
    bool is_airfoil() const { return layout_ == TextLayout::airfoil; }
    void restart();
    void advance();
    std::string_view fill();
    void take_line(std::string_view& text);
    std::string_view take_lines(std::string_view text);
    void take_rows(std::string_view text);
    std::vector<std::string_view> cut(std::string_view text) const;
    void make_room(LargeArray& values, std::size_t ready) const;

    std::filesystem::path path_;
    std::unique_ptr<ByteSource> bytes_;
    TextParts parts_;
    TextLayout layout_;
    TextScanner scanner_;
    Index rows_ = -1;

    LargeArray buffer_;          ///< bytes, what is left of the last part first
    std::string_view carried_{}; ///< the line in it whose end was not read yet
    std::uint64_t bytes_read_ = 0;
    bool at_end_ = false; ///< of the bytes
    Index lines_ = 0;     ///< taken
    Index not_finite_line_ = 0;

    std::vector<double> head_; ///< rows that were taken line by line
    std::vector<TextRows> blocks_;
    std::vector<std::span<const double>> ready_; ///< in order
    std::size_t next_part_ = 0;                  ///< of these to hand out
    std::size_t given_ = 0;                      ///< numbers of it
    std::size_t numbers_ = 0;                    ///< handed out in this pass
    bool is_fresh_ = false;                      ///< nothing was handed out since the beginning
};

} // namespace batten
