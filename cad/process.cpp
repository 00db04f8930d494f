#include "process.hpp"

#include "message.hpp"

#include <batten/core/core.hpp>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace batten::cad {

namespace {

constexpr int patience = 100; // milliseconds between two questions whether to go on

[[noreturn]] void fail(std::string_view what, int error) {
    throw Failed(fmt::format("{}: {}", what, std::strerror(error)));
}

/// The two ends of a line between processes; neither goes to a program that is started.
class Line {
  public:
    Line() {
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_) != 0)
            fail("no line to batten-cad", errno);
    }
    ~Line() {
        close(ends_[0]);
        hang_up_far_end();
    }
    Line(const Line&) = delete;
    Line& operator=(const Line&) = delete;
    int near() const { return ends_[0]; }
    int far() const { return ends_[1]; }
    void hang_up_far_end() {
        if (ends_[1] >= 0) close(ends_[1]);
        ends_[1] = -1;
    }

  private:
    int ends_[2] = {-1, -1};
};

/// How posix_spawn is to start the program: `far` is its standard input, all it prints is lost.
class Start {
  public:
    explicit Start(int far) {
        posix_spawn_file_actions_init(&files_);
        posix_spawn_file_actions_adddup2(&files_, far, STDIN_FILENO);
        for (int file : {STDOUT_FILENO, STDERR_FILENO})
            posix_spawn_file_actions_addopen(&files_, file, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_addclosefrom_np(&files_, STDERR_FILENO + 1);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_init(&attributes_);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
        posix_spawnattr_setpgroup(&attributes_, 0); // Ctrl-C is the caller's to act upon
        posix_spawnattr_setsigmask(&attributes_, &none);
    }
    ~Start() {
        posix_spawn_file_actions_destroy(&files_);
        posix_spawnattr_destroy(&attributes_);
    }
    Start(const Start&) = delete;
    Start& operator=(const Start&) = delete;

    pid_t operator()(const std::filesystem::path& program) const {
        std::string name = program.string();
        std::string caller = std::to_string(getpid());
        char* arguments[] = {name.data(), caller.data(), nullptr};
        pid_t process = 0;
        const int error =
            posix_spawn(&process, name.c_str(), &files_, &attributes_, arguments, environ);
        if (error != 0) fail(name + " cannot be started", error);
        return process;
    }

  private:
    posix_spawn_file_actions_t files_{};
    posix_spawnattr_t attributes_{};
};

/// A started program, ended with the object.
class Process {
  public:
    explicit Process(pid_t process) : process_(process) {}
    ~Process() {
        if (process_ == 0) return;
        kill(process_, SIGKILL);
        wait();
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    /// The status of waitpid; 0 where the caller's program takes no notice of processes that end.
    int wait() {
        int status = 0;
        while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
        process_ = 0;
        return status;
    }

  private:
    pid_t process_;
};

/// Sends what can be sent without waiting; the rest of the request is returned.
std::string_view sent(int line, std::string_view request) {
    const ssize_t count = send(line, request.data(), request.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) request.remove_prefix(static_cast<std::size_t>(count));
    const bool gone = count < 0 && errno != EAGAIN && errno != EINTR;
    if (gone) request = {}; // the program has ended: its status says why
    if (request.empty()) shutdown(line, SHUT_WR);
    return request;
}

/// Hands over the request and takes the answer, until the program closes its end.
std::string converse(int line, std::string_view request, const std::function<bool()>& cancelled) {
    std::string answer;
    char buffer[1 << 16];
    while (true) {
        if (cancelled && cancelled()) throw Cancelled("cancelled");
        const int wanted = request.empty() ? POLLIN : POLLIN | POLLOUT;
        pollfd place{line, static_cast<short>(wanted), 0};
        if (poll(&place, 1, patience) <= 0) continue;
        if ((place.revents & POLLOUT) != 0 && !request.empty()) request = sent(line, request);
        if ((place.revents & ~POLLOUT) == 0) continue;
        const ssize_t count = recv(line, buffer, sizeof buffer, MSG_DONTWAIT);
        if (count > 0)
            answer.append(buffer, static_cast<std::size_t>(count));
        else if (count == 0 || (errno != EAGAIN && errno != EINTR))
            return answer;
    }
}

void check_end(int status) {
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        if (signal == SIGXCPU) throw Failed("it came to no end in the processor time allowed");
        const char* name = sigdescr_np(signal);
        throw Failed(fmt::format("signal {}: {}", signal, name == nullptr ? "unknown" : name));
    }
    if (WEXITSTATUS(status) != 0)
        throw Failed(fmt::format("batten-cad ended with status {}", WEXITSTATUS(status)));
}

} // namespace

std::string answer_of(const std::filesystem::path& program, std::string_view request,
                      const std::function<bool()>& cancelled) {
    Line line;
    Process process(Start(line.far())(program));
    line.hang_up_far_end();
    std::string answer = converse(line.near(), request, cancelled);
    check_end(process.wait());
    return answer;
}

} // namespace batten::cad
