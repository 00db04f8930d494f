#include <batten/core/large_array.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <sys/mman.h>
#include <utility>

namespace batten {

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20U;
constexpr std::size_t mapped_from = huge_page; // bytes; below, pages of one's own gain nothing

/// Pages for `bytes`, a multiple of a huge page, that begin where a huge page may.
void* map_pages(std::size_t bytes) {
    void* found = ::mmap(nullptr, bytes + huge_page, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (found == MAP_FAILED) throw std::bad_alloc();
    char* begin = static_cast<char*>(found);
    const std::size_t before =
        (huge_page - reinterpret_cast<std::uintptr_t>(begin) % huge_page) % huge_page;
    if (before > 0) ::munmap(begin, before);
    if (before < huge_page) ::munmap(begin + before + bytes, huge_page - before);
    ::madvise(begin + before, bytes, MADV_HUGEPAGE); // where it is not known, small pages do
    return begin + before;
}

/// The pages of `old` under a new address with room for more: tables change, no content moves.
void* moved_pages(void* old, std::size_t old_bytes, std::size_t bytes) {
    void* place = map_pages(bytes);
    if (::mremap(old, old_bytes, old_bytes, MREMAP_MAYMOVE | MREMAP_FIXED, place) != MAP_FAILED)
        return place;
    ::munmap(place, bytes);
    throw std::bad_alloc();
}

} // namespace

LargeArray::LargeArray(LargeArray&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      bytes_(std::exchange(other.bytes_, 0)) {}

LargeArray& LargeArray::operator=(LargeArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

LargeArray::~LargeArray() {
    release();
}

void LargeArray::release() noexcept {
    if (bytes_ >= mapped_from)
        ::munmap(data_, bytes_);
    else
        std::free(data_);
    data_ = nullptr;
    size_ = bytes_ = 0;
}

void LargeArray::resize(std::size_t size) {
    if (size * sizeof(double) > bytes_) reserve(bytes_ == 0 ? size : std::max(size, size_ * 2));
    size_ = size;
}

void LargeArray::reserve(std::size_t size) {
    if (size > PTRDIFF_MAX / sizeof(double) - huge_page) throw std::bad_alloc();
    std::size_t bytes = size * sizeof(double);
    if (bytes <= bytes_) return;
    void* place = nullptr;
    if (bytes < mapped_from) {
        place = std::realloc(data_, bytes);
        if (place == nullptr) throw std::bad_alloc();
    } else {
        bytes = (bytes + huge_page - 1) / huge_page * huge_page;
        if (bytes_ >= mapped_from) {
            place = moved_pages(data_, bytes_, bytes);
        } else {
            place = map_pages(bytes);
            if (size_ > 0) std::copy_n(data_, size_, static_cast<double*>(place));
            std::free(data_);
        }
    }
    data_ = static_cast<double*>(place);
    bytes_ = bytes;
}

Points LargeArray::points(Index count, Index dim) && {
    auto owner = std::make_shared<LargeArray>(std::move(*this));
    const double* values = owner->data();
    return {std::shared_ptr<const double>(std::move(owner), values), count, dim};
}

} // namespace batten
