#include <batten/io/output_set.hpp>

#include <batten/core/errors.hpp>
#include <batten/io/staged_file.hpp>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace batten {

namespace {

std::atomic<bool> some_placed = false;

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
    throw FileError(fmt::format("{}: cannot be written: {}",
                                path == "-" ? "standard output" : path.string(),
                                std::strerror(error)));
}

/// A descriptor closed with its scope.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() { close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }
    /// The error's number, or 0.
    int close() {
        const int error = number_ >= 0 && ::close(number_) != 0 ? errno : 0;
        number_ = -1;
        return error;
    }

  private:
    int number_;
};

/// Connected to the socket at `path`, or -1 with errno set.
int connected(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.native().size() >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    std::memcpy(address.sun_path, path.c_str(), path.native().size());
    const int number = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (number < 0 ||
        ::connect(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
        return number;
    const int error = errno;
    ::close(number);
    errno = error;
    return -1;
}

void write_stream(const std::filesystem::path& name, const OutputPlace& place,
                  std::string_view content) {
    if (place.kind == OutputKind::descriptor) {
        if (std::fflush(stdout) != 0) fail(name, errno); // what was printed before comes first
        if (const int error = write_all(place.descriptor, content)) fail(name, error);
        return;
    }
    Descriptor file(std::filesystem::is_socket(place.path)
                        ? connected(place.path)
                        : ::open(place.path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (file.number() < 0) fail(name, errno);
    int error = write_all(file.number(), content);
    if (const int at_end = file.close(); error == 0) error = at_end;
    if (error != 0) fail(name, error);
}

} // namespace

OutputSet::OutputSet() = default;
OutputSet::~OutputSet() = default;

void OutputSet::add(const std::filesystem::path& path, std::string content) {
    OutputPlace place = output_place(path);
    if (place.kind == OutputKind::file)
        files_.push_back(std::make_unique<StagedFile>(path, std::move(place.path), content));
    else
        streams_.push_back({path, std::move(place), std::move(content)});
}

void OutputSet::put_in_place() {
    for (const Stream& stream : streams_) write_stream(stream.path, stream.place, stream.content);
    streams_.clear();
    const SignalsHeld held;
    std::size_t placed = 0;
    try {
        for (; placed < files_.size(); ++placed) files_[placed]->put_in_place();
    } catch (const FileError&) {
        while (placed-- > 0) files_[placed]->take_back();
        throw;
    }
    some_placed = some_placed || !files_.empty();
    files_.clear();
}

bool any_put_in_place() noexcept {
    return some_placed;
}

} // namespace batten
