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
#include <utility>

namespace batten {

namespace {

constexpr mode_t all_may = 0666; // less what umask takes

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view what, int error) {
    throw FileError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(error)));
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
    static std::atomic<int> number = 0;
    return path.parent_path() / fmt::format(".batten-{}-{}.part", ::getpid(), number++);
}

/// The open file's entry in /proc, by which it can be given a name.
std::string entry_of(int descriptor) {
    return fmt::format("/proc/self/fd/{}", descriptor);
}

/// A new file of the folder without a name that can be given one later; -1 where there is no such.
int nameless_file(const std::filesystem::path& folder) {
    const int descriptor =
        ::open(folder.empty() ? "." : folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, all_may);
    if (descriptor < 0 || ::access(entry_of(descriptor).c_str(), F_OK) == 0) return descriptor;
    ::close(descriptor);
    return -1;
}

/// Gives the open file a name that must be free; whether that could be done.
bool give_name(int descriptor, const std::filesystem::path& name) {
    return ::linkat(AT_FDCWD, entry_of(descriptor).c_str(), AT_FDCWD, name.c_str(),
                    AT_SYMLINK_FOLLOW) == 0;
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
                       std::string_view content, Waiting waiting)
    : name_(std::move(name)), path_(std::move(path)), temporary_(temporary_name(path_)) {
    const char* temporary = temporary_.path().c_str();
    if (waiting == Waiting::nameless) nameless_ = nameless_file(path_.parent_path());
    const bool named = nameless_ < 0;
    const int descriptor =
        named ? ::open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, all_may)
              : nameless_;
    if (descriptor < 0) fail(name_, "cannot be written", errno);
    take_over(descriptor, path_);
    int error = write_all(descriptor, content);
    // some file systems tell only when a descriptor is closed, be it a copy
    const int last = named ? descriptor : ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    if ((last < 0 || ::close(last) != 0) && error == 0) error = errno;
    if (error == 0) return;
    named ? ::unlink(temporary) : ::close(nameless_);
    fail(name_, "cannot be written", error);
}

StagedFile::~StagedFile() {
    // after an exchange the temporary name is that of the old file
    if (state_ == State::staged || state_ == State::exchanged) ::unlink(temporary_.path().c_str());
    if (nameless_ >= 0) ::close(nameless_);
}

void StagedFile::put_in_place() {
    const char* from = temporary_.path().c_str();
    if (nameless_ >= 0) {
        if (give_name(nameless_, path_)) {
            state_ = State::created;
            return;
        }
        if (errno != EEXIST || !give_name(nameless_, temporary_.path()))
            fail(name_, "cannot be replaced", errno);
        ::close(std::exchange(nameless_, -1));
    }
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
