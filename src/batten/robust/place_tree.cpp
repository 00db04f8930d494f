#include <batten/robust/place_tree.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace batten {

namespace {

constexpr double as_far = 1 + 1e-9; ///< square

}

PlaceTree::PlaceTree(const Points& places)
    : places_(places.size(), places.dim()), order_(static_cast<std::size_t>(places.size())) {
    std::vector<Placed> all(order_.size());
    for (Index i = 0; i < places.size(); ++i) {
        Placed& placed = all[static_cast<std::size_t>(i)];
        placed = {{}, i};
        std::ranges::copy(places[i], placed.at.begin());
    }
    if (!all.empty()) divide(all, 0, std::ssize(all));
    for (Index i = 0; i < size(); ++i) {
        const Placed& placed = all[static_cast<std::size_t>(i)];
        order_[static_cast<std::size_t>(i)] = placed.number;
        std::copy_n(placed.at.begin(), places.dim(), places_[i].begin());
    }
}

/// Into halves across the longest side of their box, but none between places that are the same.
void PlaceTree::divide(std::span<Placed> all, Index begin, Index end) {
    const auto node = nodes_.size();
    nodes_.push_back({begin, end});
    const auto part =
        all.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    if (std::ssize(part) <= most_alike) return;
    std::array<double, 3> low = part[0].at;
    std::array<double, 3> high = low;
    for (const Placed& placed : part)
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = std::min(low[d], placed.at[d]);
            high[d] = std::max(high[d], placed.at[d]);
        }
    std::size_t axis = 0;
    for (std::size_t d = 1; d < 3; ++d)
        if (high[d] - low[d] > high[axis] - low[axis]) axis = d;
    if (!(high[axis] > low[axis])) return;
    const auto along = [axis](const Placed& placed) { return placed.at[axis]; };
    const auto half = part.begin() + std::ssize(part) / 2;
    std::ranges::nth_element(part, half, {}, along);
    const double middle = along(*half);
    auto second =
        std::partition(part.begin(), half, [&](const Placed& p) { return along(p) < middle; });
    if (second == part.begin())
        second =
            std::partition(half, part.end(), [&](const Placed& p) { return along(p) <= middle; });
    const double below = along(*std::ranges::max_element(part.begin(), second, {}, along));
    const double above = along(*std::ranges::min_element(second, part.end(), {}, along));
    const Index at = begin + (second - part.begin());
    divide(all, begin, at);
    const auto follows = static_cast<Index>(nodes_.size());
    divide(all, at, end);
    nodes_[node] = {begin, end, static_cast<int>(axis), below, above, follows};
}

/// One question on its way through the tree.
struct PlaceTree::Search {
    const PlaceTree& tree;
    Index place;
    Index count;
    const Metric& metric;
    std::span<const char> wanted;
    Neighbours& found;
    std::array<double, 3> at{};
    double farthest = std::numeric_limits<double>::infinity(); ///< square
    std::size_t most = 2 * static_cast<std::size_t>(count);

    /// `square` of the distance of the node's box, `off` per axis.
    void visit(Index index, double square, const std::array<double, 3>& off) {
        const Node& node = tree.nodes_[static_cast<std::size_t>(index)];
        if (node.axis == leaf) return scan(node);
        const auto axis = static_cast<std::size_t>(node.axis);
        const auto half = [&](Index next, double beyond) {
            std::array<double, 3> there = off;
            there[axis] = std::max(there[axis], metric[axis] * beyond);
            const double farther = square + (there[axis] * there[axis] - off[axis] * off[axis]);
            if (farther <= farthest) visit(next, farther, there);
        };
        const double past = at[axis] - node.below;
        const double before = node.above - at[axis];
        if (past < before) {
            half(index + 1, past);
            half(node.second, before);
        } else {
            half(node.second, before);
            half(index + 1, past);
        }
    }

    void scan(const Node& node) {
        Index left = most_alike;
        for (Index i = node.begin; i < node.end && left > 0; ++i) {
            if (i == place || !wanted[static_cast<std::size_t>(i)]) continue;
            --left;
            double square = 0;
            for (std::size_t d = 0; d < static_cast<std::size_t>(tree.places_.dim()); ++d) {
                const double far = metric[d] * (std::as_const(tree.places_)[i][d] - at[d]);
                square += far * far;
            }
            if (square > farthest) continue;
            found.push_back({square, i});
            if (found.size() >= most) keep_nearest();
        }
    }

    void keep_nearest() {
        if (std::ssize(found) < count) return;
        std::ranges::nth_element(found, found.begin() + count - 1, {}, &Neighbour::square);
        farthest = as_far * found[static_cast<std::size_t>(count - 1)].square;
        std::erase_if(found, [&](const Neighbour& n) { return n.square > farthest; });
        most = std::max(most, 2 * found.size());
    }
};

void PlaceTree::nearest(Index place, Index count, const Metric& metric,
                        std::span<const char> wanted, Neighbours& found) const {
    found.clear();
    Search search{*this, place, count, metric, wanted, found};
    std::ranges::copy(places_[place], search.at.begin());
    search.visit(0, 0, {});
    search.keep_nearest();
    std::ranges::sort(found, [](const Neighbour& a, const Neighbour& b) {
        return a.square < b.square || (a.square == b.square && a.place < b.place);
    });
    const std::size_t most = 2 * static_cast<std::size_t>(count);
    if (found.size() <= most) return;
    // of those that are as far as the last, some from all around
    const auto ties = std::ranges::partition_point(found, [&](const Neighbour& n) {
        return n.square * as_far * as_far < found.back().square;
    });
    std::ranges::sort(ties, found.end(), {}, &Neighbour::place);
    const auto count_of_ties = static_cast<std::size_t>(found.end() - ties);
    const std::size_t nearer = found.size() - count_of_ties;
    for (std::size_t k = nearer; k < most; ++k)
        found[k] = found[nearer + (k - nearer) * count_of_ties / (most - nearer)];
    found.resize(most);
}

} // namespace batten
