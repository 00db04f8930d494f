#include <batten/io/staged_file.hpp>

#include <batten/core/errors.hpp>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace batten {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view what, int error) {
    throw FileError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(error)));
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
    static std::atomic<int> number = 0;
    return path.parent_path() / fmt::format(".batten-{}-{}.part", ::getpid(), number++);
}

/// Gives an open file the mode and, where that is allowed, the owner of the one that it replaces.
void take_over(int descriptor, const std::filesystem::path& path) {
    struct stat old {};
    if (::stat(path.c_str(), &old) != 0) return;
    if (::fchown(descriptor, old.st_uid, old.st_gid) != 0 &&
        ::fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) != 0)
        errno = 0; // an ordinary user's files are his own
    ::fchmod(descriptor, old.st_mode & 07777U);
}

} // namespace

int write_all(int descriptor, std::string_view content) {
    while (!content.empty()) {
        const ssize_t count = ::write(descriptor, content.data(), content.size());
        if (count >= 0) {
            content.remove_prefix(static_cast<std::size_t>(count));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            pollfd ready{descriptor, POLLOUT, 0};
            ::poll(&ready, 1, -1);
        } else if (errno != EINTR) {
            return errno;
        }
    }
    return 0;
}

StagedFile::StagedFile(std::filesystem::path name, std::filesystem::path path,
                       std::string_view content)
    : name_(std::move(name)), path_(std::move(path)), temporary_(temporary_name(path_)) {
    constexpr mode_t all_may = 0666; // less what umask takes
    const char* temporary = temporary_.path().c_str();
    const int descriptor =
        ::open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, all_may);
    if (descriptor < 0) fail(name_, "cannot be written", errno);
    take_over(descriptor, path_);
    int error = write_all(descriptor, content);
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (error == 0) return;
    ::unlink(temporary);
    fail(name_, "cannot be written", error);
}

StagedFile::~StagedFile() {
    // after an exchange the temporary name is that of the old file
    if (state_ == State::staged || state_ == State::exchanged) ::unlink(temporary_.path().c_str());
}

void StagedFile::put_in_place() {
    const char* from = temporary_.path().c_str();
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) == 0) {
        state_ = State::exchanged;
        return;
    }
    const bool none_yet = errno == ENOENT;
    const bool no_exchange = errno == EINVAL || errno == ENOSYS; // the file system cannot
    if (!(none_yet || no_exchange) || std::rename(from, path_.c_str()) != 0)
        fail(name_, "cannot be replaced", errno);
    state_ = none_yet ? State::created : State::replaced;
}

void StagedFile::take_back() noexcept {
    if (state_ == State::exchanged) {
        ::renameat2(AT_FDCWD, temporary_.path().c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE);
        state_ = State::staged;
    } else if (state_ == State::created) {
        ::unlink(path_.c_str());
    }
}

} // namespace batten
