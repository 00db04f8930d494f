#include <batten/core/counts.hpp>
#include <batten/core/errors.hpp>

#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using namespace batten;

__extension__ using Wide = __int128; // holds every product of two counts

std::string refusal(const std::vector<Index>& counts) {
    try {
        checked_product(counts, "grid");
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(CheckedProduct, IsTheProductWhereItFits) {
    EXPECT_EQ(checked_product({}, "x"), 1);
    EXPECT_EQ(checked_product(std::array<Index, 3>{81, 40, 7}, "x"), 81 * 40 * 7);
    EXPECT_EQ(checked_product(std::array<Index, 2>{3037000499, 3037000499}, "x"),
              9223372030926249001);
    EXPECT_EQ(checked_product(std::array<Index, 3>{1L << 40, 1L << 40, 0}, "x"), 0);
    EXPECT_EQ(checked_product(std::array<Index, 3>{0, 1L << 40, 1L << 40}, "x"), 0);
}

TEST(CheckedProduct, NamesWhatIsBeyondCounting) {
    // 11 * 1676976733973595647 is 2^64 + 501: unchecked it comes out as 501
    EXPECT_EQ(refusal({11, 1676976733973595647}),
              "grid: 11x1676976733973595647 is more than can be counted");
    EXPECT_EQ(refusal({3037000500, 3037000500}),
              "grid: 3037000500x3037000500 is more than can be counted");
    EXPECT_EQ(refusal({-2, -3}), "grid: -2 in -2x-3 is negative");
    // against multiplication in 128 bits
    constexpr Index most = std::numeric_limits<Index>::max();
    std::uint64_t seed = 1;
    for (int k = 0; k < 10000; ++k) {
        seed = seed * 6364136223846793005U + 1442695040888963407U;
        const auto a = static_cast<Index>(seed >> (1 + seed % 60));
        seed = seed * 6364136223846793005U + 1442695040888963407U;
        const auto b = static_cast<Index>(seed >> (1 + seed % 60));
        EXPECT_EQ(refusal({a, b}).empty(), static_cast<Wide>(a) * b <= most) << a << " " << b;
    }
}

TEST(CheckMemory, RefusesWhatNoMachineHolds) {
    EXPECT_NO_THROW(check_memory(1000, "points"));
    EXPECT_NO_THROW(check_memory(2 << 20, "points"));
    try {
        check_memory(std::numeric_limits<Index>::max() / 8, "points");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with("points: 9.22e+09 GB of memory would"))
            << error.what();
    }
}

#ifndef __SANITIZE_ADDRESS__ // which needs the address space itself
TEST(CheckMemory, KnowsTheProcessLimit) {
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit half{1UL << 31, 1UL << 31};
        ::setrlimit(RLIMIT_AS, &half);
        try {
            check_memory(4 << 20, "points"); // 32 MB of 2 GB
        } catch (const InvalidInput&) {
            ::_exit(1);
        }
        try {
            check_memory(1L << 28, "points"); // 2 GB, beside what runs already
        } catch (const InvalidInput&) {
            ::_exit(0);
        }
        ::_exit(2);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
}
#endif

} // namespace
