#pragma once

#include <batten/io/output_place.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

class StagedFile;

/// Outputs that belong together: all are made first, then put in place at once, so that a failure
/// leaves every old file as it was. Without put_in_place nothing stays.
class OutputSet {
  public:
    OutputSet();
    ~OutputSet();
    OutputSet(const OutputSet&) = delete;
    OutputSet& operator=(const OutputSet&) = delete;

    /// Writes `content` beside the file that it is to become, with that file's mode and, where
    /// that is allowed, owner; what goes to a stream waits in memory. A symbolic link stays, its
    /// target becomes new. Throws FileError.
    void add(const std::filesystem::path& path, std::string content);

    /// Writes into the streams, then gives all files their names; signals wait for that last step.
    /// Throws FileError, and then no file has changed (on a file system that can exchange two
    /// names; else those before the failing one have).
    void put_in_place();

  private:
    struct Stream {
        std::filesystem::path path;
        OutputPlace place;
        std::string content;
    };
    std::vector<Stream> streams_;
    std::vector<std::unique_ptr<StagedFile>> files_;
};

/// Whether this process has put a file in place; may be called by a signal's handler.
bool any_put_in_place() noexcept;

} // namespace batten
