#include <batten/io/byte_source.hpp>

#include <batten/core/errors.hpp>
#include <batten/core/threads.hpp>
#include <batten/io/output_file.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace batten {

namespace {

[[noreturn]] void fail(const std::string& name, int error) {
    throw FileError(fmt::format("{}: cannot be read: {}", name, std::strerror(error)));
}

/// An open file, pipe or device.
class FileBytes final : public ByteSource {
  public:
    FileBytes(std::string name, int descriptor, ReadObserver observer)
        : name_(std::move(name)), descriptor_(descriptor), observer_(std::move(observer)) {
        opened_ = state();
        if (S_ISDIR(opened_.st_mode)) fail(name_, EISDIR);
        // files of the kernel state no size, and standard input may stand somewhere in its file
        const off_t begin = S_ISREG(opened_.st_mode) ? ::lseek(descriptor_, 0, SEEK_CUR) : -1;
        if (begin < 0 || opened_.st_size <= begin) return;
        begin_ = begin;
        size_ = opened_.st_size - begin;
    }
    ~FileBytes() override {
        if (descriptor_ != STDIN_FILENO) ::close(descriptor_);
    }

    std::int64_t size() const override { return size_; }
    std::uint64_t bytes_read() const override { return total_; }
    std::size_t read(std::span<char> into) override {
        return size_ < 0 ? read_stream(into) : read_file(into);
    }
    void seek(std::uint64_t place) override {
        check_unchanged();
        at_ = static_cast<std::int64_t>(place);
    }

    /// The open file stays the same one even where another takes its name, but may be written to.
    void check_unchanged() const override {
        if (size_ < 0) return;
        const struct stat now = state();
        if (now.st_size != opened_.st_size)
            throw FileError(fmt::format("{}: changed while it was read: {} bytes before, {} now",
                                        name_, opened_.st_size, now.st_size));
        if (now.st_mtim.tv_sec != opened_.st_mtim.tv_sec ||
            now.st_mtim.tv_nsec != opened_.st_mtim.tv_nsec)
            throw FileError(fmt::format("{}: changed while it was read: written to", name_));
    }

  private:
    struct stat state() const {
        struct stat now {};
        if (::fstat(descriptor_, &now) != 0) fail(name_, errno);
        return now;
    }

    std::size_t read_stream(std::span<char> into) {
        std::size_t done = 0;
        while (done < into.size()) {
            const ssize_t count = ::read(descriptor_, into.data() + done, into.size() - done);
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(name_, errno);
            if (count == 0) break;
            done += static_cast<std::size_t>(count);
        }
        at_ += static_cast<std::int64_t>(done);
        total_ += done;
        if (observer_) observer_({.bytes = static_cast<double>(at_)});
        return done;
    }

    std::size_t read_file(std::span<char> into) {
        constexpr Index round = Index{1} << 26; // between two words to the observer
        const auto count = static_cast<Index>(std::min<std::uint64_t>(into.size(), size_ - at_));
        for (Index done = 0; done < count; done += round) {
            const Index part = std::min(round, count - done);
            read_part(into.data() + done, part);
            at_ += part;
            total_ += static_cast<std::uint64_t>(part);
            if (observer_) observer_({static_cast<double>(at_), static_cast<double>(size_)});
        }
        if (at_ == size_) check_unchanged();
        return static_cast<std::size_t>(count);
    }

    /// All threads read, since touching the memory for the bytes is most of the work.
    void read_part(char* into, Index count) const {
        constexpr Index block_size = Index{1} << 20;
        std::atomic<int> error = 0;
        std::atomic<bool> ended = false;
        for_each_block(count, block_size, [&](const Block& block) {
            for (Index at = block.begin; at < block.end;) {
                const ssize_t got =
                    ::pread(descriptor_, into + at, static_cast<std::size_t>(block.end - at),
                            begin_ + at_ + at);
                if (got < 0 && errno == EINTR) continue;
                if (got < 0) error = errno;
                if (got == 0) ended = true;
                if (got <= 0) return;
                at += got;
            }
        });
        if (error != 0) fail(name_, error);
        if (!ended) return;
        check_unchanged();
        throw FileError(fmt::format("{}: changed while it was read", name_));
    }

    std::string name_;
    int descriptor_;
    ReadObserver observer_;
    struct stat opened_ {};
    std::int64_t begin_ = 0;
    std::int64_t size_ = -1;
    std::int64_t at_ = 0;
    std::uint64_t total_ = 0;
};

class MemoryBytes final : public ByteSource {
  public:
    explicit MemoryBytes(std::string_view bytes) : bytes_(bytes) {}
    std::int64_t size() const override { return static_cast<std::int64_t>(bytes_.size()); }
    std::size_t read(std::span<char> into) override {
        const std::size_t count = bytes_.copy(into.data(), into.size(), at_);
        at_ += count;
        return count;
    }
    void seek(std::uint64_t place) override { at_ = static_cast<std::size_t>(place); }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

} // namespace

std::string input_name(const std::filesystem::path& path) {
    return path == "-" ? "standard input" : path.string();
}

std::unique_ptr<ByteSource> open_bytes(const std::filesystem::path& path, ReadAgain again,
                                       const ReadObserver& observer) {
    const std::string name = input_name(path);
    const int descriptor =
        path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0) fail(name, errno);
    std::unique_ptr<ByteSource> bytes = std::make_unique<FileBytes>(name, descriptor, observer);
    if (again == ReadAgain::yes && bytes->size() < 0) bytes = spooled(name, std::move(bytes));
    return extension(path) == ".gz" ? uncompressed(path, std::move(bytes)) : std::move(bytes);
}

std::unique_ptr<ByteSource> bytes_in_memory(std::string_view bytes) {
    return std::make_unique<MemoryBytes>(bytes);
}

} // namespace batten
