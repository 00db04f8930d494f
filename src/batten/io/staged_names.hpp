#pragma once

#include <csignal>
#include <filesystem>

namespace batten {

/// Keeps the name of a temporary file while it lives, so that a signal's handler can remove the
/// file.
class StagedName {
  public:
    explicit StagedName(std::filesystem::path path);
    ~StagedName();
    StagedName(const StagedName&) = delete;
    StagedName& operator=(const StagedName&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    struct Entry;
    friend void remove_staged_files() noexcept;

    std::filesystem::path path_;
    Entry* entry_;
};

/// Removes the temporary files whose names are kept now, for a program that is about to end; may be
/// called by a signal's handler.
void remove_staged_files() noexcept;

/// Holds back this thread's signals while it lives: they are delivered afterwards.
class SignalsHeld {
  public:
    SignalsHeld();
    ~SignalsHeld();
    SignalsHeld(const SignalsHeld&) = delete;
    SignalsHeld& operator=(const SignalsHeld&) = delete;

  private:
    sigset_t before_;
};

} // namespace batten
