#include <batten/io/byte_source.hpp>

#include <batten/core/errors.hpp>
#include <batten/io/staged_file.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace batten {

namespace {

/// A new file without a name in the folder for temporary files; -1 with errno set.
int unnamed_file(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
    if (descriptor >= 0 || errno == ENOENT || errno == EACCES) return descriptor;
    std::string name = (folder / "batten-XXXXXX").string(); // the file system knows no such files
    const int named = ::mkostemp(name.data(), O_CLOEXEC);
    if (named >= 0) ::unlink(name.c_str());
    return named;
}

class SpooledBytes final : public ByteSource {
  public:
    SpooledBytes(std::string name, std::unique_ptr<ByteSource> stream)
        : name_(std::move(name)), stream_(std::move(stream)) {
        const char* folder = std::getenv("TMPDIR");
        file_ = unnamed_file(folder != nullptr && *folder != '\0' ? folder : "/tmp");
        if (file_ < 0) fail(errno);
    }
    ~SpooledBytes() override {
        if (file_ >= 0) ::close(file_);
    }

    std::int64_t size() const override { return ended_ ? kept_ : -1; }

    std::size_t read(std::span<char> into) override {
        std::size_t done = 0;
        while (done < into.size() && at_ < kept_) {
            const auto part = std::min<std::uint64_t>(into.size() - done, kept_ - at_);
            const ssize_t got = ::pread(file_, into.data() + done, part, at_);
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) fail(got < 0 ? errno : EIO);
            again_read_ += static_cast<std::uint64_t>(got);
            advance(static_cast<std::size_t>(got), done);
        }
        if (done == into.size() || ended_) return done;
        const std::size_t fresh = stream_->read(into.subspan(done));
        ended_ = fresh < into.size() - done;
        if (const int error = write_all(file_, {into.data() + done, fresh})) fail(error);
        kept_ += static_cast<std::int64_t>(fresh);
        advance(fresh, done);
        return done;
    }

    void seek(std::uint64_t place) override {
        again_ = again_ || (place == 0 && at_ > 0 && !as_a_whole_);
        at_ = static_cast<std::int64_t>(place);
    }

    std::uint64_t bytes_read() const override { return stream_->bytes_read() + again_read_; }
    std::string note() const override {
        return again_ ? name_ + ": kept in a temporary file, to be read more than once" : "";
    }

    void read_to_the_end() {
        std::vector<char> part(std::size_t{1} << 18);
        while (!ended_) read(part);
        as_a_whole_ = true;
        at_ = 0;
    }

  private:
    void advance(std::size_t count, std::size_t& done) {
        at_ += static_cast<std::int64_t>(count);
        done += count;
    }
    [[noreturn]] void fail(int error) const {
        throw FileError(
            fmt::format("{}: cannot be kept in a temporary file: {}", name_, std::strerror(error)));
    }

    std::string name_;
    std::unique_ptr<ByteSource> stream_;
    int file_ = -1;
    std::int64_t kept_ = 0;
    std::int64_t at_ = 0;
    std::uint64_t again_read_ = 0;
    bool ended_ = false;
    bool again_ = false;      ///< more than one pass was asked for
    bool as_a_whole_ = false; ///< it was needed for one, too
};

} // namespace

std::unique_ptr<ByteSource> spooled(const std::string& name, std::unique_ptr<ByteSource> stream) {
    return std::make_unique<SpooledBytes>(name, std::move(stream));
}

std::unique_ptr<ByteSource> sized_and_not_empty(const std::filesystem::path& path,
                                                std::unique_ptr<ByteSource> source) {
    if (source->size() < 0) {
        auto kept = std::make_unique<SpooledBytes>(input_name(path), std::move(source));
        kept->read_to_the_end();
        source = std::move(kept);
    }
    if (source->size() == 0) throw FileError(fmt::format("{}: the file is empty", path.string()));
    return source;
}

} // namespace batten
