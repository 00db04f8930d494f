#include <batten/core/threads.hpp>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace batten {

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
    if (count == 1 || thread_count() == 1) { // starting the scheduler costs more than a small fit
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
