#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace batten::command {

/// A line on standard error that says what is being done, shown only on a terminal and only after a
/// second.
class Progress {
  public:
    /// `quiet`: never show.
    enum class Show { when_slow, never };
    explicit Progress(Show show);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void say(std::string text);

  private:
    void run(const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::string text_;
    std::jthread thread_;
};

} // namespace batten::command
