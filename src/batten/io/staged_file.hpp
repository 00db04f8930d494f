#pragma once

#include <batten/io/staged_names.hpp>

#include <filesystem>
#include <string_view>

namespace batten {

/// A complete file under a temporary name in the folder where it belongs; removed with the object
/// unless it was put in place.
class StagedFile {
  public:
    /// `path`: the file to become, behind all links; `name` what the caller calls it. Throws
    /// FileError when it cannot be written.
    StagedFile(std::filesystem::path name, std::filesystem::path path, std::string_view content);
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
    StagedName temporary_;
    State state_ = State::staged;
};

/// Writes all of `content`, waiting where the descriptor does not take it yet; the error's number,
/// or 0.
int write_all(int descriptor, std::string_view content);

} // namespace batten
