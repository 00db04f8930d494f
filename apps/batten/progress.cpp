#include "progress.hpp"

#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace batten::command {

Progress::Progress(Show show) {
    if (show == Show::when_slow && ::isatty(STDERR_FILENO) != 0)
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Progress::~Progress() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    wake_.notify_all();
}

void Progress::say(std::string text) {
    const std::scoped_lock lock(mutex_);
    text_ = std::move(text);
}

void Progress::run(const std::stop_token& stop) {
    using namespace std::chrono_literals;
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    bool shown = false;
    auto pause = 1000ms;
    while (!stop.stop_requested()) {
        wake_.wait_for(lock, stop, pause, [] { return false; });
        if (stop.stop_requested()) break;
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        fmt::print(stderr, "\r\033[K{} ({:.0f} s)", text_, seconds);
        std::fflush(stderr);
        shown = true;
        pause = 200ms;
    }
    if (shown) fmt::print(stderr, "\r\033[K");
}

} // namespace batten::command
