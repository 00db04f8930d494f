#pragma once

#include <batten/io/byte_source.hpp>
#include <batten/io/number_reader.hpp>

#include <bit>
#include <memory>
#include <vector>

namespace batten {

enum class NumberKind {
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float32,
    float64
};

/// Bytes that a number of the kind takes.
std::size_t width(NumberKind kind);

/// A number in every record: the stored one, or `scale` times it plus `offset`.
struct RecordField {
    std::size_t place; ///< bytes from the record's first
    NumberKind kind;
    bool scaled = false;
    double scale = 1;
    double offset = 0;
};

/// Records of one length, one after the other: where they stand and what of them is read.
struct RecordLayout {
    std::uint64_t begin = 0; ///< bytes before the first
    std::uint64_t count = 0;
    std::size_t length = 0; ///< bytes of each
    std::endian order = std::endian::little;
    std::vector<RecordField> fields{};
};

/// Reads numbers out of records. What is stored as double already, nothing between, goes straight
/// to where it is wanted; else records pass through one buffer of a fixed size.
class RecordReader final : public NumberReader {
  public:
    /// `shape` has as many numbers as all records together; `bytes` reach to the last.
    RecordReader(std::string path, std::unique_ptr<ByteSource> bytes, RecordLayout layout,
                 std::vector<Index> shape);

    std::vector<Index> shape() const override { return shape_; }
    std::size_t read(std::span<double> into) override;
    void rewind() override;
    std::vector<std::string> notes() const override;
    std::uint64_t bytes_read() const override { return bytes_->bytes_read(); }
    std::string path() const override { return path_; }

  private:
    bool is_plain() const;
    void read_bytes(std::span<char> into);
    void advance(std::size_t count);
    void refill();

    std::string path_;
    std::unique_ptr<ByteSource> bytes_;
    RecordLayout layout_;
    std::vector<Index> shape_;
    std::vector<char> buffer_; ///< records as they stand in the file
    LargeArray numbers_;       ///< those of the records in the buffer
    std::size_t given_ = 0;    ///< of these
    std::uint64_t next_ = 0;   ///< the record, or plain number, to go on with
};

} // namespace batten
