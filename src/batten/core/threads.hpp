#pragma once

#include <batten/core/index.hpp>

#include <algorithm>
#include <functional>

namespace batten {

/// Limits every pass of this library to `count` threads while the object lives; 0 means all cores.
class ThreadLimit {
  public:
    explicit ThreadLimit(int count);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    struct State;
    State* state_;
};

/// Calls `work(k)` once for every k in [0, count), in any order, on the threads allowed, or on as
/// many of them as the system gives.
///
/// Results stay bit-identical for any number of threads when each call writes its own place
/// and the caller merges the places in the order of k.
void for_each_chunk(Index count, const std::function<void(Index)>& work);

/// Positions [begin, end): block `index` of those that some positions are cut into.
struct Block {
    Index index;
    Index begin;
    Index end;
};

/// Blocks of `size` positions, the last perhaps shorter, that hold `count` positions.
inline Index block_count(Index count, Index size) {
    return count / size + (count % size > 0 ? 1 : 0);
}

/// Calls `work(block)` once for every block of `size` positions, as for_each_chunk does.
template <class Work>
void for_each_block(Index count, Index size, const Work& work) {
    for_each_chunk(block_count(count, size), [&](Index k) {
        work(Block{k, k * size, std::min(count, (k + 1) * size)});
    });
}

/// Threads that for_each_chunk may use now.
int thread_count();

} // namespace batten
