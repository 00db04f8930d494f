#include <batten/core/errors.hpp>
#include <batten/core/grid_index.hpp>

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <vector>

namespace batten {
namespace {

/// Every index tuple of the shape in row-major order, by plain recursion.
std::vector<std::vector<Index>> tuples(const std::vector<Index>& shape) {
    std::vector<std::vector<Index>> result{{}};
    for (Index length : shape) {
        std::vector<std::vector<Index>> next;
        for (const auto& tuple : result)
            for (Index i = 0; i < length; ++i) {
                next.push_back(tuple);
                next.back().push_back(i);
            }
        result = std::move(next);
    }
    return result;
}

const std::vector<std::vector<Index>> shapes = {{1},    {7},       {3, 4},    {4, 1},
                                                {1, 5}, {2, 3, 4}, {3, 1, 2}, {2, 3, 4, 5}};

GridIndex::Place padded(const std::vector<Index>& tuple) {
    GridIndex::Place place{};
    std::ranges::copy(tuple, place.begin());
    return place;
}

TEST(GridIndex, CountsRowMajorOrderInBothDirections) {
    for (const auto& shape : shapes) {
        const GridIndex grid(shape);
        const auto all = tuples(shape);
        ASSERT_EQ(grid.size(), static_cast<Index>(all.size()));
        ASSERT_EQ(grid.axis_count(), shape.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            EXPECT_EQ(grid.at(padded(all[k])), static_cast<Index>(k));
            EXPECT_EQ(grid.place(static_cast<Index>(k)), padded(all[k]));
        }
    }
}

TEST(GridIndex, VisitsEveryPlaceInOrder) {
    for (const auto& shape : shapes) {
        const auto all = tuples(shape);
        std::size_t seen = 0;
        GridIndex(shape).for_each([&](const GridIndex::Place& place, Index position) {
            ASSERT_LT(seen, all.size());
            EXPECT_EQ(position, static_cast<Index>(seen));
            EXPECT_EQ(place, padded(all[seen++]));
        });
        EXPECT_EQ(seen, all.size());
    }
}

TEST(GridIndex, StrandsHoldTheTuplesThatDifferInOneIndex) {
    for (const auto& shape : shapes)
        for (std::size_t axis = 0; axis < shape.size(); ++axis) {
            const auto all = tuples(shape);
            std::set<Index> seen;
            Index before = -1;
            GridIndex(shape).for_each_strand(axis, [&](const GridIndex::Strand& strand) {
                EXPECT_GT(strand.first, before);
                before = strand.first;
                ASSERT_EQ(strand.count, shape[axis]);
                std::vector<Index> tuple = all[static_cast<std::size_t>(strand.first)];
                for (Index i = 0; i < strand.count; ++i) {
                    tuple[axis] = i;
                    EXPECT_EQ(all[static_cast<std::size_t>(strand[i])], tuple);
                    EXPECT_TRUE(seen.insert(strand[i]).second);
                }
            });
            EXPECT_EQ(seen.size(), all.size());
        }
}

TEST(GridIndex, BlocksTimesLengthTimesStrideIsTheSize) {
    const GridIndex grid{2, 3, 4};
    EXPECT_EQ(grid.blocks(0), 1);
    EXPECT_EQ(grid.stride(0), 12);
    EXPECT_EQ(grid.blocks(1), 2);
    EXPECT_EQ(grid.stride(1), 4);
    EXPECT_EQ(grid.blocks(2), 6);
    EXPECT_EQ(grid.stride(2), 1);
}

TEST(GridIndex, AnEmptyAxisMakesAnEmptyGrid) {
    const GridIndex grid{3, 0, 2};
    EXPECT_EQ(grid.size(), 0);
    grid.for_each([](const GridIndex::Place&, Index) { FAIL(); });
}

TEST(GridIndex, RefusesWhatCannotBeCounted) {
    constexpr Index most = std::numeric_limits<Index>::max();
    EXPECT_EQ(GridIndex({most, 1, 1}).size(), most);
    EXPECT_EQ(GridIndex({7, most / 7}).size(), most / 7 * 7);
    EXPECT_THROW(GridIndex({2, most}), InvalidInput);
    EXPECT_THROW(GridIndex({11, 1676976733973595647}), InvalidInput);
    EXPECT_THROW(GridIndex({most, 0, 2}), InvalidInput); // the product of the others
    EXPECT_THROW(GridIndex({3, -1}), InvalidInput);
    EXPECT_THROW(GridIndex(std::vector<Index>{}), InvalidInput);
    EXPECT_THROW(GridIndex({1, 2, 3, 4, 5}), InvalidInput);
    try {
        GridIndex({2, most});
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_STREQ(e.what(), "grid: 2x9223372036854775807 are more places than can be counted");
    }
}

} // namespace
} // namespace batten
