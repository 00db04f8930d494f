#include "problems.hpp"

#include <batten/robust/place_tree.hpp>

#include <algorithm>
#include <cmath>

namespace batten {
namespace {

PointSet random_places(Index count, Index axes, unsigned seed) {
    return testing::random_points(count, axes, seed);
}

PointSet lattice(Index side) {
    PointSet places(side * side, 2);
    for (Index i = 0; i < places.size(); ++i) {
        places(i, 0) = static_cast<double>(i / side);
        places(i, 1) = static_cast<double>(i % side);
    }
    return places;
}

double square(const PointSet& places, Index a, Index b, const Metric& metric) {
    double sum = 0;
    for (Index d = 0; d < places.dim(); ++d)
        sum += std::pow(metric[static_cast<std::size_t>(d)] * (places(a, d) - places(b, d)), 2);
    return sum;
}

/// Squares of the distances to the nearest, by asking everyone.
std::vector<double> by_all(const PlaceTree& tree, Index place, Index count, const Metric& metric,
                           const std::vector<char>& wanted) {
    std::vector<double> squares;
    for (Index i = 0; i < tree.size(); ++i)
        if (i != place && wanted[static_cast<std::size_t>(i)])
            squares.push_back(square(tree.places(), place, i, metric));
    std::ranges::sort(squares);
    if (std::ssize(squares) <= count) return squares;
    const double last = squares[static_cast<std::size_t>(count - 1)] * (1 + 1e-9);
    std::erase_if(squares, [&](double x) { return x > last; });
    return squares;
}

TEST(PlaceTree, finds_what_asking_everyone_finds) {
    for (const PointSet& places : {random_places(500, 1, 1), random_places(700, 2, 2),
                                   random_places(600, 3, 3), lattice(20), lattice(1)})
        for (const Metric& metric : {Metric{1, 1, 1}, Metric{1, 1.0 / 64, 8}, Metric{1, 512, 1}}) {
            const PlaceTree tree(places);
            std::vector<char> wanted(static_cast<std::size_t>(tree.size()), 1);
            for (std::size_t i = 0; i < wanted.size(); i += 7) wanted[i] = 0;
            PlaceTree::Neighbours found;
            for (Index place = 0; place < tree.size(); place += 11)
                for (Index count : {1, 9, 40}) {
                    tree.nearest(place, count, metric, wanted, found);
                    std::vector<double> squares;
                    for (const auto& [far, other] : found) {
                        EXPECT_NE(other, place);
                        EXPECT_TRUE(wanted[static_cast<std::size_t>(other)]);
                        EXPECT_DOUBLE_EQ(far, square(tree.places(), place, other, metric));
                        squares.push_back(far);
                    }
                    const std::vector<double> all = by_all(tree, place, count, metric, wanted);
                    ASSERT_EQ(squares.size(), std::min<std::size_t>(
                                                  all.size(), 2 * static_cast<std::size_t>(count)));
                    for (std::size_t k = 0; k < squares.size(); ++k)
                        EXPECT_NEAR(squares[k], all[k], 1e-9 * all[k]);
                }
        }
}

TEST(PlaceTree, keeps_every_place_once) {
    const PointSet places = random_places(1000, 2, 4);
    const PlaceTree tree(places);
    std::vector<char> seen(1000, 0);
    for (Index i = 0; i < tree.size(); ++i) {
        ++seen[static_cast<std::size_t>(tree.original(i))];
        for (Index d = 0; d < 2; ++d) EXPECT_EQ(tree.places()(i, d), places(tree.original(i), d));
    }
    EXPECT_EQ(std::ranges::count(seen, 1), 1000);
}

TEST(PlaceTree, asks_eight_at_most_of_one_place_and_some_of_a_circle) {
    PointSet places = random_places(2000, 2, 5);
    for (Index i = 0; i < 1000; ++i) places(i, 0) = places(i, 1) = 0.5;
    const double turn = 2 * std::acos(-1.0) / 500;
    for (Index i = 1000; i < 1500; ++i) { // as far from the place as each other
        places(i, 0) = 0.5 + 10 * std::cos(turn * static_cast<double>(i));
        places(i, 1) = 0.5 + 10 * std::sin(turn * static_cast<double>(i));
    }
    const PlaceTree tree(places);
    const std::vector<char> wanted(2000, 1);
    PlaceTree::Neighbours found;
    for (Index i = 0; i < tree.size(); ++i) {
        if (tree.original(i) != 0) continue;
        tree.nearest(i, 20, {1, 1, 1}, wanted, found);
        EXPECT_EQ(std::ranges::count(found, 0.0, &PlaceTree::Neighbour::square), 8);
        tree.nearest(i, 800, {1, 1, 1}, wanted, found);
        EXPECT_LE(found.size(), 1600U);
        EXPECT_GE(found.size(), 800U);
    }
}

} // namespace
} // namespace batten
