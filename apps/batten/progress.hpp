#pragma once

#include <batten/io/points_file.hpp>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace batten::command {

/// A line on standard error that says what is being done, shown only on a terminal, only after a
/// second, and only where a thread can be had for it.
class Progress {
  public:
    enum class Show { when_slow, never };
    explicit Progress(Show show);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void say(std::string text);
    /// "reading FILE: 120 of 240 MB, 800 MB/s, 1 s left"; reading began with this object.
    void say_read(const std::string& file, const ReadProgress& now);

  private:
    double seconds() const;
    void run(const std::stop_token& stop);

    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::string text_;
    std::jthread thread_;
};

/// Takes a line off the terminal.
inline constexpr std::string_view erased_line = "\r\033[K";

/// Whether the line stands there now; may be called by a signal's handler.
bool progress_is_shown() noexcept;

} // namespace batten::command
