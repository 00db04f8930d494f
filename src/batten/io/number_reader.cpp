#include <batten/io/number_reader.hpp>

#include <batten/core/counts.hpp>

#include <algorithm>

namespace batten {

NumberArray NumberReader::all() {
    NumberArray result{{}, shape(), {}};
    const Index count = checked_product(result.shape, path());
    check_memory(count, path());
    result.values.resize(static_cast<std::size_t>(count));
    for (std::size_t done = 0; done < result.values.size();)
        done += read({result.values.data() + done, result.values.size() - done});
    result.notes = notes();
    return result;
}

std::size_t HeldNumbers::read(std::span<double> into) {
    const std::size_t count = std::min(into.size(), numbers_.values.size() - next_);
    std::copy_n(numbers_.values.data() + next_, count, into.begin());
    next_ += count;
    return count;
}

} // namespace batten
