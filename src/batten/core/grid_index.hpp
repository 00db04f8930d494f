#pragma once

#include <batten/core/index.hpp>

#include <array>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

namespace batten {

/// Positions in a row-major array of 1 to 4 axes, the last axis fastest: which position an index
/// per axis has, and which indices are at a position.
class GridIndex {
  public:
    static constexpr std::size_t most_axes = 4; ///< three parametric ones and the coordinates
    /// One index per axis, zero beyond the last axis.
    using Place = std::array<Index, most_axes>;

    /// The positions along one axis, all other indices fixed.
    struct Strand {
        Index first;
        Index count;
        Index stride;
        Index operator[](Index i) const { return first + i * stride; }
    };

    /// Throws InvalidInput when there are no axes or more than four, a length is negative, or the
    /// product of the lengths is more than an Index can count.
    explicit GridIndex(std::span<const Index> shape);
    GridIndex(std::initializer_list<Index> shape) : GridIndex(std::span(shape)) {}
    explicit GridIndex(const std::vector<Index>& shape) : GridIndex(std::span(shape)) {}

    /// Number of positions: the product of the lengths.
    Index size() const { return size_; }
    std::size_t axis_count() const { return axis_count_; }
    std::span<const Index> shape() const { return {length_.data(), axis_count_}; }
    /// Indices along an axis; 1 beyond the last axis.
    Index length(std::size_t axis) const { return length_[axis]; }
    /// Distance of neighbours along an axis: the product of the lengths after it.
    Index stride(std::size_t axis) const { return stride_[axis]; }
    /// Number of blocks that follow each other, each holding the axis once: the product of the
    /// lengths before it.
    Index blocks(std::size_t axis) const;

    Index at(const Place& place) const {
        Index position = 0;
        for (std::size_t k = 0; k < most_axes; ++k) position += place[k] * stride_[k];
        return position;
    }
    Place place(Index position) const {
        Place place{};
        for (std::size_t k = axis_count_; k-- > 1;) {
            place[k] = position % length_[k];
            position /= length_[k];
        }
        place[0] = position;
        return place;
    }

    /// Calls `visit(place, position)` for every position in order.
    template <class Visit>
    void for_each(Visit visit) const {
        Place place{};
        for (Index position = 0; position < size_; ++position) {
            visit(std::as_const(place), position);
            for (std::size_t k = axis_count_; k-- > 0;) {
                if (++place[k] < length_[k]) break;
                place[k] = 0;
            }
        }
    }

    /// Calls `visit(strand)` for every strand along the axis, in the order of their first
    /// positions.
    template <class Visit>
    void for_each_strand(std::size_t axis, Visit visit) const {
        const Index count = length(axis);
        const Index step = stride(axis);
        for (Index block = 0; block < blocks(axis); ++block)
            for (Index inner = 0; inner < step; ++inner)
                visit(Strand{block * count * step + inner, count, step});
    }

  private:
    std::size_t axis_count_;
    Index size_ = 1;
    Place length_{1, 1, 1, 1};
    Place stride_{1, 1, 1, 1};
};

} // namespace batten
