#include <batten/core/distinct.hpp>
#include <batten/core/function_ref.hpp>
#include <batten/core/threads.hpp>
#include <batten/core/vectors.hpp>

#include <atomic>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

namespace batten {
namespace {

TEST(Blocks, hold_every_position_once) {
    for (Index count : {0, 1, 7, 8, 9, 1000})
        for (Index size : {1, 3, 8, 2000}) {
            std::vector<std::atomic<int>> seen(static_cast<std::size_t>(count));
            std::atomic<Index> blocks = 0;
            for_each_block(count, size, [&](const Block& block) {
                ++blocks;
                EXPECT_LT(block.begin, block.end);
                EXPECT_LE(block.end - block.begin, size);
                EXPECT_EQ(block.begin, block.index * size);
                for (Index i = block.begin; i < block.end; ++i) ++seen[static_cast<std::size_t>(i)];
            });
            EXPECT_EQ(blocks, block_count(count, size));
            for (const auto& times : seen) EXPECT_EQ(times, 1);
        }
    EXPECT_EQ(block_count(std::numeric_limits<Index>::max(), 2),
              std::numeric_limits<Index>::max() / 2 + 1);
}

TEST(Vectors, add_scaled_takes_any_length) {
    for (Index count = 0; count < 9; ++count) {
        std::vector<double> x(9);
        std::iota(x.begin(), x.end(), 1);
        std::vector<double> y(9, 0.5);
        add_scaled(y.data(), 2, x.data(), count);
        for (Index k = 0; k < 9; ++k)
            EXPECT_EQ(y[static_cast<std::size_t>(k)],
                      k < count ? 0.5 + 2 * static_cast<double>(k + 1) : 0.5);
    }
    EXPECT_EQ(dot(std::vector{1.0, 2.0, 3.0}, std::vector{4.0, 5.0, 6.0}), 32);
    EXPECT_EQ(norm(std::vector{3.0, 4.0}), 5);
    EXPECT_EQ(difference(std::vector{3.0, 4.0}, std::vector{1.0, 5.0}), (std::vector{2.0, -1.0}));
}

TEST(Distinct, keeps_one_of_each) {
    EXPECT_EQ(distinct(std::vector{3, 1, 3, 2, 1}), (std::vector{1, 2, 3}));
    EXPECT_EQ(without_repeats(std::vector{3, 3, 1, 3}), (std::vector{3, 1, 3}));
    EXPECT_TRUE(distinct(std::vector<int>{}).empty());
}

TEST(FunctionRef, calls_what_it_was_made_of) {
    int sum = 0;
    const auto add = [&](int x) { return sum += x; };
    const FunctionRef<int(int)> ref = add;
    const FunctionRef<int(int)> copy = ref; // refers to the callable, not to the reference
    EXPECT_EQ(ref(2), 2);
    EXPECT_EQ(copy(3), 5);
    EXPECT_EQ(sum, 5);
}

} // namespace
} // namespace batten
