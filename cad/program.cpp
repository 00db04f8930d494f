// batten-cad: Open CASCADE in a process of its own. Reads one message from standard input, writes
// one back to the same place.
#include "cad_formats.hpp"
#include "message.hpp"

#include <batten/core/core.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <new>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

using namespace batten;
using namespace batten::cad;

constexpr int line = STDIN_FILENO;
constexpr rlim_t mebibyte = 1U << 20U;

/// Ends this process with the caller; false when that has ended already.
bool tie_to(const std::string& caller) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    return std::to_string(getppid()) == caller;
}

/// Lowers a limit, never raises it; what is beyond `hard` is the kernel's to end.
void limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
    rlimit now{};
    if (getrlimit(resource, &now) != 0) return;
    now.rlim_max = std::min(now.rlim_max, hard);
    now.rlim_cur = std::min({now.rlim_cur, soft, now.rlim_max});
    setrlimit(resource, &now);
}

/// Bytes of address space in use.
rlim_t address_space() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// A damaged file must not hold the machine: many times what Open CASCADE takes for whole ones
/// (0.1 s and 12 bytes of memory for each byte).
void limit_to(std::size_t request) {
    const rlim_t seconds = 5 + 10 * request / mebibyte;
    std::signal(SIGXCPU, SIG_DFL);
    limit(RLIMIT_CPU, seconds, seconds + 1);
    const rlim_t memory = address_space() + 1024 * mebibyte + 64 * request;
    limit(RLIMIT_AS, memory, memory);
    limit(RLIMIT_CORE, 0, 0);
}

std::string heard() {
    std::string message;
    char buffer[1 << 16];
    ssize_t count = 0;
    while ((count = read(line, buffer, sizeof buffer)) > 0)
        message.append(buffer, static_cast<std::size_t>(count));
    return message;
}

void say(std::string_view message) {
    while (!message.empty()) {
        const ssize_t count = send(line, message.data(), message.size(), MSG_NOSIGNAL);
        if (count < 0) return;
        message.remove_prefix(static_cast<std::size_t>(count));
    }
}

Packer read_task(Task task, Unpacker& request) {
    const std::string path = request.take_text();
    const std::string content = request.take_text();
    const SplineFile file =
        task == Task::read_step ? parse_step(path, content) : parse_iges(path, content);
    Packer reply;
    reply.put(static_cast<std::int64_t>(Outcome::done));
    reply.put(static_cast<std::int64_t>(file.splines.size()));
    for (const Spline& spline : file.splines) reply.put(spline);
    reply.put(static_cast<std::int64_t>(file.notes.size()));
    for (const std::string& note : file.notes) reply.put(note);
    return reply;
}

Packer write_task(Task task, Unpacker& request) {
    const std::string title = request.take_text();
    const std::string unit = request.take_text();
    const std::string date = request.take_text();
    std::vector<Spline> splines;
    for (std::int64_t count = request.take_number(); count > 0; --count)
        splines.push_back(request.take_spline());
    if (splines.empty()) throw Failed("no spline was given");
    Scene scene{.spline = splines.front(), .title = title, .unit = unit, .date = date};
    for (std::size_t k = 1; k < splines.size(); ++k) scene.more.push_back(&splines[k]);
    Packer reply;
    reply.put(static_cast<std::int64_t>(Outcome::done));
    reply.put(task == Task::write_step ? step_text(scene) : iges_text(scene));
    return reply;
}

Packer refusal(Outcome outcome, std::string_view words) {
    Packer reply;
    reply.put(static_cast<std::int64_t>(outcome));
    reply.put(words);
    return reply;
}

Packer reply_to(std::string message) {
    try {
        Unpacker request(std::move(message));
        const auto task = static_cast<Task>(request.take_number());
        const bool reading = task == Task::read_step || task == Task::read_iges;
        return reading ? read_task(task, request) : write_task(task, request);
    } catch (const InvalidInput& error) {
        return refusal(Outcome::invalid_input, error.what());
    } catch (const FileError& error) {
        return refusal(Outcome::file_error, error.what());
    } catch (const std::bad_alloc&) {
        return refusal(Outcome::failed, "it wants more memory than is allowed");
    } catch (const std::exception& error) {
        return refusal(Outcome::failed, error.what());
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2 || !tie_to(argv[1])) {
        fmt::print(stderr, "batten-cad: it is started by batten, for STEP and IGES files\n");
        return 2;
    }
    std::string request = heard();
    limit_to(request.size());
    say(reply_to(std::move(request)).finish());
    _exit(0); // Open CASCADE's own tidying up could fail, and takes time
}
