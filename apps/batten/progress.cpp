#include "progress.hpp"

#include <algorithm>
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

void Progress::say_read(const std::string& file, const ReadProgress& now) {
    const double rate = now.bytes / std::max(seconds(), 1e-3);
    std::string words = fmt::format("reading {}: {:.0f}", file, now.bytes / 1e6);
    if (now.of > 0) words += fmt::format(" of {:.0f}", now.of / 1e6);
    words += fmt::format(" MB, {:.0f} MB/s", rate / 1e6);
    if (now.of > 0) words += fmt::format(", {:.0f} s left", (now.of - now.bytes) / rate);
    say(std::move(words));
}

double Progress::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::run(const std::stop_token& stop) {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    auto pause = 1000ms;
    while (!stop.stop_requested()) {
        wake_.wait_for(lock, stop, pause, [] { return false; });
        if (stop.stop_requested()) break;
        shown = true;
        fmt::print(stderr, "{}{} ({:.0f} s)", erased_line, text_, seconds());
        std::fflush(stderr);
        pause = 200ms;
    }
    if (shown.exchange(false)) fmt::print(stderr, "{}", erased_line);
}

} // namespace batten::command
