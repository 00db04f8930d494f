#include <batten/io/buffered_bytes.hpp>

#include <batten/core/errors.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace batten {

BufferedBytes::BufferedBytes(const std::filesystem::path& path, std::unique_ptr<ByteSource> source)
    : path_(path.string()),
      source_(std::move(source)),
      size_(static_cast<std::uint64_t>(source_->size())) {
    source_->seek(0);
}

void BufferedBytes::fail_short(std::string_view what, std::uint64_t wanted) const {
    throw FileError(
        fmt::format("{}: the file ends at byte {}, {} needs {}", path_, size_, what, wanted));
}

void BufferedBytes::seek(std::uint64_t place, std::string_view what) {
    if (place > size_) fail_short(what, place);
    if (place >= begin_ && place <= begin_ + buffer_.size()) {
        next_ = static_cast<std::size_t>(place - begin_);
        return;
    }
    source_->seek(place);
    buffer_.clear();
    begin_ = place;
    next_ = 0;
}

std::string_view BufferedBytes::ahead(std::size_t count) {
    constexpr std::size_t least = std::size_t{1} << 16;
    if (buffer_.size() - next_ < count) {
        buffer_.erase(0, next_);
        begin_ += next_;
        next_ = 0;
        const std::size_t there = buffer_.size();
        const auto left = static_cast<std::size_t>(size_ - begin_) - there;
        const std::size_t wanted = std::min(std::max(least, count - there), left);
        buffer_.resize(there + wanted);
        if (source_->read({buffer_.data() + there, wanted}) != wanted)
            throw FileError(fmt::format("{}: changed while it was read", path_));
    }
    return std::string_view(buffer_).substr(next_, count);
}

std::size_t BufferedBytes::find(std::string_view ends) {
    std::size_t searched = 0;
    for (std::size_t wanted = 1;; wanted *= 2) {
        const std::string_view there = ahead(std::max(wanted, buffer_.size() - next_));
        const std::size_t found = there.find_first_of(ends, searched);
        if (found != std::string_view::npos || there.size() == left()) return found;
        searched = there.size();
        wanted = std::max(wanted, searched);
    }
}

bool BufferedBytes::starts_with(std::string_view text) {
    return ahead(text.size()).starts_with(text);
}

bool BufferedBytes::line(std::string_view& text) {
    if (left() == 0) return false;
    if (ended_line(text)) return true;
    text = std::string_view(buffer_).substr(next_);
    next_ += text.size();
    return true;
}

bool BufferedBytes::ended_line(std::string_view& text) {
    const std::size_t end = find("\n");
    if (end == std::string_view::npos) return false;
    text = std::string_view(buffer_).substr(next_, end);
    next_ += end + 1;
    return true;
}

std::string_view BufferedBytes::word() {
    constexpr std::string_view blanks = " \t\r\n";
    while (true) {
        const std::string_view there = ahead(1);
        if (there.empty() || blanks.find(there[0]) == std::string_view::npos) break;
        ++next_;
    }
    const std::size_t end = find(blanks);
    return std::string_view(buffer_).substr(next_, end);
}

} // namespace batten
