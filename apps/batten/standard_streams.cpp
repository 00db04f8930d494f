#include "standard_streams.hpp"

#include <batten/core/errors.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace batten::command {

void fill_closed_streams() {
    for (int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(number, F_GETFD) >= 0) continue;
        // the lowest free number is taken: this one; the wrong way round it cannot be used
        ::open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
}

void finish_standard_output() {
    errno = 0;
    const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (written) return;
    throw FileError(fmt::format("standard output: cannot be written{}{}", errno != 0 ? ": " : "",
                                errno != 0 ? std::strerror(errno) : ""));
}

} // namespace batten::command
