#include <batten/core/grid_index.hpp>

#include <batten/core/errors.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

GridIndex::GridIndex(std::span<const Index> shape) : axis_count_(shape.size()) {
    if (shape.empty() || shape.size() > most_axes)
        throw InvalidInput(
            fmt::format("grid: {} axes given, 1 to {} are possible", shape.size(), most_axes));
    for (std::size_t k = 0; k < shape.size(); ++k)
        if (shape[k] < 0)
            throw InvalidInput(fmt::format("grid: axis {} of {} places cannot be", k, shape[k]));
    std::ranges::copy(shape, length_.begin());
    // lengths of zero count as one on the way, so that what the others multiply to is checked too
    Index product = 1;
    for (std::size_t k = shape.size(); k-- > 0;) {
        stride_[k] = product;
        if (__builtin_mul_overflow(product, std::max<Index>(1, length_[k]), &product))
            throw InvalidInput(
                fmt::format("grid: {} are more places than can be counted", fmt::join(shape, "x")));
    }
    size_ = std::ranges::find(shape, 0) == shape.end() ? product : 0;
}

Index GridIndex::blocks(std::size_t axis) const {
    Index product = 1;
    for (std::size_t k = 0; k < axis; ++k) product *= length_[k];
    return product;
}

} // namespace batten
