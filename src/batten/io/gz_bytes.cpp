#include <batten/io/byte_source.hpp>

#include <batten/core/errors.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <new>
#include <utility>
#include <vector>
#include <zlib.h>

namespace batten {

namespace {

class GzBytes final : public ByteSource {
  public:
    GzBytes(std::string name, std::unique_ptr<ByteSource> compressed)
        : name_(std::move(name)), compressed_(std::move(compressed)), input_(std::size_t{1} << 17) {
        constexpr int gzip_only = 16 + MAX_WBITS;
        if (::inflateInit2(&state_, gzip_only) != Z_OK) throw std::bad_alloc();
    }
    ~GzBytes() override { ::inflateEnd(&state_); }

    std::int64_t size() const override { return -1; }

    std::size_t read(std::span<char> into) override {
        std::size_t done = 0;
        while (done < into.size() && !ended_) {
            if (state_.avail_in == 0 && !fill()) break;
            if (member_ended_ && !next_member()) break;
            constexpr std::size_t most = std::size_t{1} << 30; // zlib counts in 32 bits
            const std::size_t room = std::min(into.size() - done, most);
            state_.next_out = reinterpret_cast<Bytef*>(into.data() + done);
            state_.avail_out = static_cast<uInt>(room);
            const int result = ::inflate(&state_, Z_NO_FLUSH);
            if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) fail();
            member_ended_ = result == Z_STREAM_END;
            done += room - state_.avail_out;
        }
        return done;
    }

    void seek(std::uint64_t) override {
        compressed_->seek(0);
        ::inflateReset(&state_);
        state_.avail_in = 0;
        ended_ = member_ended_ = some_ = false;
    }

    std::uint64_t bytes_read() const override { return compressed_->bytes_read(); }
    std::string note() const override { return compressed_->note(); }

  private:
    /// The next compressed bytes; false at their end, which must be that of a member.
    bool fill() {
        const std::size_t count = compressed_->read(input_);
        state_.next_in = reinterpret_cast<Bytef*>(input_.data());
        state_.avail_in = static_cast<uInt>(count);
        ended_ = count == 0;
        if (ended_ && some_ && !member_ended_)
            throw FileError(fmt::format("{}: the compressed file ends too early", name_));
        some_ = some_ || count > 0;
        return !ended_;
    }

    /// After a member's end another may follow, or zeros that fill up a block of a tape.
    bool next_member() {
        while (true) {
            while (state_.avail_in > 0 && *state_.next_in == 0) {
                ++state_.next_in;
                --state_.avail_in;
            }
            if (state_.avail_in > 0) break;
            if (!fill()) return false;
        }
        ::inflateReset(&state_);
        member_ended_ = false;
        return true;
    }

    [[noreturn]] void fail() const {
        throw FileError(fmt::format("{}: not a sound .gz file: {}", name_,
                                    state_.msg != nullptr ? state_.msg : "damaged"));
    }

    std::string name_;
    std::unique_ptr<ByteSource> compressed_;
    std::vector<char> input_;
    z_stream state_{};
    bool some_ = false; ///< whether there was a byte at all
    bool member_ended_ = false;
    bool ended_ = false;
};

} // namespace

std::unique_ptr<ByteSource> uncompressed(const std::filesystem::path& path,
                                         std::unique_ptr<ByteSource> compressed) {
    return std::make_unique<GzBytes>(path.string(), std::move(compressed));
}

} // namespace batten
