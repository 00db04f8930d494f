#include <batten/io/record_reader.hpp>

#include <batten/core/errors.hpp>
#include <batten/core/threads.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>

namespace batten {

namespace {

template <class Number>
double number_at(const char* at, bool swapped) {
    unsigned char bytes[sizeof(Number)];
    std::memcpy(bytes, at, sizeof(Number));
    if (swapped) std::reverse(bytes, bytes + sizeof(Number));
    Number value;
    std::memcpy(&value, bytes, sizeof(Number));
    return static_cast<double>(value);
}

/// One field of `count` records at `records`, into every `stride`-th place of `out`.
template <class Number>
void take_field(const char* records, std::size_t length, bool swapped, const RecordField& field,
                std::size_t count, std::size_t stride, double* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const double value = number_at<Number>(records + i * length + field.place, swapped);
        out[i * stride] = field.scaled ? value * field.scale + field.offset : value;
    }
}

using TakeField = void (*)(const char*, std::size_t, bool, const RecordField&, std::size_t,
                           std::size_t, double*);

/// Of the kinds, in their order.
struct Kind {
    std::size_t width;
    TakeField take;
};
constexpr Kind kinds[] = {{1, take_field<std::int8_t>},  {1, take_field<std::uint8_t>},
                          {2, take_field<std::int16_t>}, {2, take_field<std::uint16_t>},
                          {4, take_field<std::int32_t>}, {4, take_field<std::uint32_t>},
                          {8, take_field<std::int64_t>}, {8, take_field<std::uint64_t>},
                          {4, take_field<float>},        {8, take_field<double>}};

const Kind& of(NumberKind kind) {
    return kinds[static_cast<std::size_t>(kind)];
}

} // namespace

std::size_t width(NumberKind kind) {
    return of(kind).width;
}

RecordReader::RecordReader(std::string path, std::unique_ptr<ByteSource> bytes, RecordLayout layout,
                           std::vector<Index> shape)
    : path_(std::move(path)),
      bytes_(std::move(bytes)),
      layout_(std::move(layout)),
      shape_(std::move(shape)) {
    rewind();
}

bool RecordReader::is_plain() const {
    return layout_.fields.size() == 1 && layout_.fields[0].kind == NumberKind::float64 &&
           !layout_.fields[0].scaled && layout_.length == sizeof(double) &&
           layout_.order == std::endian::native;
}

void RecordReader::rewind() {
    bytes_->seek(layout_.begin);
    next_ = 0;
    given_ = 0;
    numbers_.resize(0);
}

std::vector<std::string> RecordReader::notes() const {
    const std::string note = bytes_->note();
    return note.empty() ? std::vector<std::string>{} : std::vector{note};
}

void RecordReader::read_bytes(std::span<char> into) {
    if (bytes_->read(into) != into.size())
        throw FileError(fmt::format("{}: changed while it was read: it ends too early", path_));
}

/// Of so many more records or numbers.
void RecordReader::advance(std::size_t count) {
    next_ += count;
    if (next_ == layout_.count) bytes_->check_unchanged();
}

std::size_t RecordReader::read(std::span<double> into) {
    if (is_plain()) {
        const std::size_t count = std::min<std::uint64_t>(into.size(), layout_.count - next_);
        read_bytes({reinterpret_cast<char*>(into.data()), count * sizeof(double)});
        advance(count);
        return count;
    }
    std::size_t done = 0;
    while (done < into.size()) {
        if (given_ == numbers_.size()) refill();
        const std::size_t count = std::min(into.size() - done, numbers_.size() - given_);
        if (count == 0) break;
        std::copy_n(numbers_.data() + given_, count, into.data() + done);
        given_ += count;
        done += count;
    }
    return done;
}

/// The numbers of the next records.
void RecordReader::refill() {
    constexpr std::size_t buffer_size = std::size_t{1} << 20;
    constexpr Index block_size = 2048;
    const std::size_t together = std::max<std::size_t>(1, buffer_size / layout_.length);
    const std::size_t count = std::min<std::uint64_t>(together, layout_.count - next_);
    buffer_.resize(count * layout_.length);
    read_bytes(buffer_);
    const std::size_t fields = layout_.fields.size();
    numbers_.resize(count * fields);
    for_each_block(static_cast<Index>(count), block_size, [&](const Block& block) {
        const auto first = static_cast<std::size_t>(block.begin);
        for (std::size_t k = 0; k < fields; ++k)
            of(layout_.fields[k].kind)
                .take(buffer_.data() + first * layout_.length, layout_.length,
                      layout_.order != std::endian::native, layout_.fields[k],
                      static_cast<std::size_t>(block.end) - first, fields,
                      numbers_.data() + first * fields + k);
    });
    advance(count);
    given_ = 0;
}

} // namespace batten
