#pragma once

#include <batten/core/large_array.hpp>

#include <span>
#include <string>
#include <vector>

namespace batten {

/// Numbers of a file with the shape they came in: {rows, columns} of a text, any shape of a .npy.
struct NumberArray {
    LargeArray values;
    std::vector<Index> shape;
    std::vector<std::string> notes;
};

/// The numbers of a file from the first to the last, as often as needed, into the place that the
/// caller has for them.
class NumberReader {
  public:
    NumberReader() = default;
    virtual ~NumberReader() = default;
    NumberReader(const NumberReader&) = delete;
    NumberReader& operator=(const NumberReader&) = delete;

    /// {rows, columns}, or any shape of a .npy; rows are -1 until a pass has come to the end where
    /// the file does not say.
    virtual std::vector<Index> shape() const = 0;
    /// Puts the next numbers into `into`, the last axis fastest, and says how many: one at least
    /// before the end, none there. Throws FileError naming path and line, or what has changed.
    virtual std::size_t read(std::span<double> into) = 0;
    /// Back to the first number. Throws FileError where the file has changed.
    virtual void rewind() = 0;
    /// What was done to the numbers on the way, as far as it is known; one sentence each.
    virtual std::vector<std::string> notes() const { return {}; }
    /// Bytes of the file read so far, in all passes.
    virtual std::uint64_t bytes_read() const { return 0; }
    /// What messages call the file.
    virtual std::string path() const = 0;
    /// The path and, where the file has lines, the line of the first number of the pass that is not
    /// finite.
    virtual std::string not_finite_place() const { return path(); }

    /// All numbers, in memory once.
    virtual NumberArray all();
};

/// Numbers that had to be taken in as a whole.
class HeldNumbers final : public NumberReader {
  public:
    HeldNumbers(std::string path, NumberArray numbers)
        : path_(std::move(path)), numbers_(std::move(numbers)) {}

    std::vector<Index> shape() const override { return numbers_.shape; }
    std::size_t read(std::span<double> into) override;
    void rewind() override { next_ = 0; }
    std::vector<std::string> notes() const override { return numbers_.notes; }
    std::string path() const override { return path_; }
    NumberArray all() override { return std::move(numbers_); }

  private:
    std::string path_;
    NumberArray numbers_;
    std::size_t next_ = 0;
};

} // namespace batten
