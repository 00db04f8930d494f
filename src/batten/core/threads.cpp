#include <batten/core/threads.hpp>

#include <atomic>
#include <latch>
#include <memory>
#include <mutex>
#include <system_error>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <thread>
#include <vector>

namespace batten {

namespace {

/// Of `wanted` threads beside the caller's those that the system lets start: limits on processes
/// or memory may leave fewer, and the scheduler ends the program when a thread fails it.
int startable(int wanted) {
    std::latch all_started{1};
    std::vector<std::jthread> threads;
    try {
        threads.reserve(static_cast<std::size_t>(wanted));
        while (static_cast<int>(threads.size()) < wanted)
            threads.emplace_back([&] { all_started.wait(); });
    } catch (const std::system_error&) {
        // these are all
    }
    all_started.count_down();
    return static_cast<int>(threads.size());
}

/// Limits the scheduler to threads that can be had, asking once for each larger number.
void limit_to_startable(int wanted) {
    static std::atomic<int> proven = 1;
    if (wanted <= proven) return;
    static std::mutex mutex;
    static std::unique_ptr<ThreadLimit> limit;
    const std::scoped_lock lock(mutex);
    if (wanted <= proven || limit) return;
    proven = 1 + startable(wanted - 1);
    if (proven < wanted) limit = std::make_unique<ThreadLimit>(proven);
}

} // namespace

struct ThreadLimit::State {
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count) : state_(nullptr) {
    if (count > 0)
        state_ = new State{
            {tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)}};
}

ThreadLimit::~ThreadLimit() {
    delete state_;
}

void for_each_chunk(Index count, const std::function<void(Index)>& work) {
    if (count > 1) limit_to_startable(thread_count());
    if (count <= 1 || thread_count() == 1) { // starting the scheduler costs more than a small fit
        for (Index k = 0; k < count; ++k) work(k);
        return;
    }
    tbb::parallel_for(
        tbb::blocked_range<Index>(0, count, 1),
        [&](const tbb::blocked_range<Index>& range) {
            for (Index k = range.begin(); k != range.end(); ++k) work(k);
        },
        tbb::simple_partitioner());
}

int thread_count() {
    return static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

} // namespace batten
