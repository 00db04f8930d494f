#include "allocations.hpp"

#include <cstdlib>
#include <new>

namespace batten::testing {

std::atomic<std::size_t> largest_allocation = 0;

} // namespace batten::testing

#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t size) {
    std::atomic<std::size_t>& largest = batten::testing::largest_allocation;
    for (std::size_t seen = largest; seen < size;)
        if (largest.compare_exchange_weak(seen, size)) break;
    void* memory = std::malloc(size > 0 ? size : 1);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}
#endif
