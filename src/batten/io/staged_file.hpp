#pragma once

#include <batten/io/staged_names.hpp>

#include <filesystem>
#include <string_view>

namespace batten {

/// How a complete file waits for its name: without any, so that nothing stays of a program that is
/// killed, where the file system knows such files; else under a temporary one.
enum class Waiting { nameless, under_a_temporary_name };

/// A complete file in the folder where it belongs; gone with the object unless it was put in place.
class StagedFile {
  public:
    /// `path`: the file to become, behind all links; `name` what the caller calls it. Throws
    /// FileError when it cannot be written.
    StagedFile(std::filesystem::path name, std::filesystem::path path, std::string_view content,
               Waiting waiting = Waiting::nameless);
    ~StagedFile();
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    /// Gives the file its name; throws FileError when that fails.
    void put_in_place();
    /// Takes that back, where the file system can: the file that was there before has its name
    /// again.
    void take_back() noexcept;

  private:
    enum class State { staged, exchanged, created, replaced };

    std::filesystem::path name_;
    std::filesystem::path path_;
    StagedName temporary_; ///< a nameless file has it while it takes another's place
    int nameless_ = -1;    ///< descriptor; -1: it has the temporary name already
    State state_ = State::staged;
};

/// Writes all of `content`, waiting where the descriptor does not take it yet; the error's number,
/// or 0.
int write_all(int descriptor, std::string_view content);

} // namespace batten
