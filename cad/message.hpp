#pragma once

#include <batten/spline/spline.hpp>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace batten::cad {

/// What `batten-cad` is asked to do.
enum class Task : std::int64_t {
    read_step, ///< path (for messages), content; answered by a count and splines
    read_iges,
    write_step, ///< title, unit, date, a count and splines; answered by the file's content
    write_iges,
};

/// How it ended; all but `done` are followed by the words.
enum class Outcome : std::int64_t { done, invalid_input, file_error, failed };

/// Open CASCADE, or the program around it, did not come to an end: why, in words.
class Failed : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A message between two processes of one version on one machine: numbers, texts and splines one
/// after the other, behind a mark and their length.
class Packer {
  public:
    Packer();
    void put(std::int64_t number);
    void put(std::string_view text);
    void put(const Spline& spline);
    /// The whole message.
    std::string finish() &&;

  private:
    void put_numbers(std::span<const double> numbers);
    std::string content_;
};

/// Takes a message apart. Each length is checked against what is there: throws Failed when the
/// message is not whole or not of this version, or a spline is none.
class Unpacker {
  public:
    explicit Unpacker(std::string message);
    std::int64_t take_number();
    std::string take_text();
    Spline take_spline();

  private:
    std::string_view take(std::size_t bytes);
    /// Takes a number that must be between `first` and `last`.
    std::int64_t take_number(std::int64_t first, std::int64_t last);
    std::vector<double> take_numbers();
    std::string message_;
    std::size_t at_ = 0;
};

} // namespace batten::cad
