#include "message.hpp"

#include <batten/core/core.hpp>

#include <cstring>
#include <limits>

namespace batten::cad {

namespace {

constexpr std::string_view mark = "batcad01";
constexpr std::size_t head = mark.size() + sizeof(std::int64_t);

[[noreturn]] void not_whole() {
    throw Failed("what batten-cad was told or answered is not whole, or of another version");
}

} // namespace

Packer::Packer() : content_(mark) {
    put(std::int64_t{0}); // the length, known at the end
}

void Packer::put(std::int64_t number) {
    content_.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void Packer::put(std::string_view text) {
    put(static_cast<std::int64_t>(text.size()));
    content_.append(text);
}

void Packer::put_numbers(std::span<const double> numbers) {
    put(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

void Packer::put(const Spline& spline) {
    put(spline.axis_count());
    for (const KnotVector& axis : spline.axes()) {
        put(axis.degree());
        put(axis.closed() ? 1 : 0);
        put_numbers(axis.knots());
    }
    const PointSet& control = spline.control_points();
    put(control.dim());
    put_numbers({control.data(), static_cast<std::size_t>(control.size() * control.dim())});
}

std::string Packer::finish() && {
    const auto length = static_cast<std::int64_t>(content_.size() - head);
    std::memcpy(content_.data() + mark.size(), &length, sizeof length);
    return std::move(content_);
}

Unpacker::Unpacker(std::string message) : message_(std::move(message)) {
    if (take(mark.size()) != mark) not_whole();
    if (take_number() != static_cast<std::int64_t>(message_.size() - head)) not_whole();
}

std::string_view Unpacker::take(std::size_t bytes) {
    if (bytes > message_.size() - at_) not_whole();
    const std::string_view taken = std::string_view(message_).substr(at_, bytes);
    at_ += bytes;
    return taken;
}

std::int64_t Unpacker::take_number() {
    std::int64_t number = 0;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
}

std::int64_t Unpacker::take_number(std::int64_t first, std::int64_t last) {
    const std::int64_t number = take_number();
    if (number < first || number > last) not_whole();
    return number;
}

std::string Unpacker::take_text() {
    const auto left = static_cast<std::int64_t>(message_.size());
    return std::string(take(static_cast<std::size_t>(take_number(0, left))));
}

std::vector<double> Unpacker::take_numbers() {
    const auto left = static_cast<std::int64_t>(message_.size());
    const std::string_view bytes = take(static_cast<std::size_t>(take_number(0, left)));
    if (bytes.size() % sizeof(double) != 0) not_whole();
    std::vector<double> numbers(bytes.size() / sizeof(double));
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

Spline Unpacker::take_spline() {
    std::vector<KnotVector> axes;
    try {
        for (std::int64_t count = take_number(1, 3); count > 0; --count) {
            const auto degree = static_cast<int>(take_number(1, max_degree));
            const Closure closure = take_number(0, 1) == 1 ? Closure::closed : Closure::open;
            axes.emplace_back(degree, take_numbers(), closure);
        }
        const std::int64_t dim = take_number(1, std::numeric_limits<std::int32_t>::max());
        std::vector<double> control = take_numbers();
        if (control.size() % static_cast<std::size_t>(dim) != 0) not_whole();
        return {std::move(axes), PointSet(std::move(control), dim)};
    } catch (const InvalidInput& error) {
        throw Failed(error.what());
    }
}

} // namespace batten::cad
