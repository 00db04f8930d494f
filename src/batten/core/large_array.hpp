#pragma once

#include <batten/core/points.hpp>

#include <cstddef>
#include <memory>
#include <span>

namespace batten {

/// Doubles in one piece that come without a value and grow without being copied: only what is
/// written takes memory, in huge pages where the system gives such to who asks. Touching fresh
/// memory may cost more than what is then done with it.
class LargeArray {
  public:
    LargeArray() = default;
    explicit LargeArray(std::size_t size) { resize(size); }
    LargeArray(LargeArray&& other) noexcept;
    LargeArray& operator=(LargeArray&& other) noexcept;
    ~LargeArray();

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    /// Numbers that there is room for.
    std::size_t capacity() const { return bytes_ / sizeof(double); }
    double* data() { return data_; }
    const double* data() const { return data_; }
    std::span<const double> values() const { return {data_, size_}; }
    double operator[](std::size_t k) const { return data_[k]; }

    /// The first numbers stay, those that are new have no value. Throws std::bad_alloc.
    void resize(std::size_t size);
    /// Room for so many numbers, so that resizing to fewer moves nothing. Throws std::bad_alloc.
    void reserve(std::size_t size);
    /// `count` points of dimension `dim` that own the memory; the array is empty afterwards.
    Points points(Index count, Index dim) &&;

  private:
    void release() noexcept;

    double* data_ = nullptr;
    std::size_t size_ = 0;
    std::size_t bytes_ = 0; ///< room; from `mapped_from` on pages of its own
};

} // namespace batten
