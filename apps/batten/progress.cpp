#include "progress.hpp"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <system_error>
#include <unistd.h>

namespace batten::command {

namespace {

std::atomic<bool> shown = false;

} // namespace

bool progress_is_shown() noexcept {
    return shown;
}

Progress::Progress(Show show) {
    if (show == Show::never || ::isatty(STDERR_FILENO) == 0) return;
    try {
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    } catch (const std::system_error&) {
        // no thread to be had: the work goes on without the line
    }
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
    auto pause = 1000ms;
    while (!stop.stop_requested()) {
        wake_.wait_for(lock, stop, pause, [] { return false; });
        if (stop.stop_requested()) break;
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        shown = true;
        fmt::print(stderr, "{}{} ({:.0f} s)", erased_line, text_, seconds);
        std::fflush(stderr);
        pause = 200ms;
    }
    if (shown.exchange(false)) fmt::print(stderr, "{}", erased_line);
}

} // namespace batten::command
