#include <batten/solve/net_dissection.hpp>

#include <algorithm>

namespace batten {

namespace {

constexpr Index small_part = 100; // control points that are not worth parting
constexpr Index small_runs = 16;  // at least so many, each by one thread

/// Control points [begin, end) along each axis.
struct Box {
    GridIndex::Place begin{};
    GridIndex::Place end{1, 1, 1, 1};

    Index size() const {
        Index product = 1;
        for (std::size_t k = 0; k < begin.size(); ++k) product *= end[k] - begin[k];
        return product;
    }
    bool contains(const GridIndex::Place& at) const {
        for (std::size_t k = 0; k < begin.size(); ++k)
            if (at[k] < begin[k] || at[k] >= end[k]) return false;
        return true;
    }
};

class Dissector {
  public:
    explicit Dissector(const std::vector<KnotVector>& axes)
        : axes_(axes), controls_(free_shape(axes)) {
        result_.place.assign(static_cast<std::size_t>(controls_.size()), 0);
    }

    NetDissection run() {
        Box all;
        for (std::size_t k = 0; k < axes_.size(); ++k) all.end[k] = controls_.length(k);
        add(all, 0);
        order_borders();
        return std::move(result_);
    }

  private:
    /// Parts a box whose axes from `closed_from` on may still go around; the index of its last
    /// part.
    Index add(const Box& box, std::size_t closed_from) {
        for (std::size_t k = closed_from; k < axes_.size(); ++k)
            if (axes_[k].closed()) return cut(box, k, 0, k + 1);
        std::size_t longest = 0;
        const auto length = [&](std::size_t k) {
            return static_cast<double>(box.end[k] - box.begin[k]) / axes_[k].degree();
        };
        for (std::size_t k = 1; k < axes_.size(); ++k)
            if (length(k) > length(longest)) longest = k;
        if (box.size() <= small_part || length(longest) < 3) return eliminate(box, box, {});
        const Index spare = box.end[longest] - box.begin[longest] - axes_[longest].degree();
        return cut(box, longest, box.begin[longest] + spare / 2, axes_.size());
    }

    Index cut(const Box& box, std::size_t axis, Index at, std::size_t closed_from) {
        Box before = box;
        Box slab = box;
        Box after = box;
        before.end[axis] = slab.begin[axis] = at;
        slab.end[axis] = after.begin[axis] =
            std::min<Index>(at + axes_[axis].degree(), box.end[axis]);
        std::vector<Index> children;
        for (const Box& half : {before, after})
            if (half.size() > 0) children.push_back(add(half, closed_from));
        return eliminate(slab, box, std::move(children));
    }

    /// Places the control points of `own` next; those of `all` are then eliminated.
    Index eliminate(const Box& own, const Box& all, std::vector<Index> children) {
        NetDissection::Part part{next_, own.size(), around(all), std::move(children)};
        GridIndex::Place at = own.begin;
        for (Index i = 0; i < part.count; ++i) {
            result_.place[static_cast<std::size_t>(controls_.at(at))] = next_++;
            for (std::size_t k = axes_.size(); k-- > 0;) {
                if (++at[k] < own.end[k]) break;
                at[k] = own.begin[k];
            }
        }
        const auto index = static_cast<Index>(result_.parts.size());
        const auto parted = static_cast<std::size_t>(index);
        begin_.push_back(part.children.empty()
                             ? index
                             : begin_[static_cast<std::size_t>(part.children.front())]);
        level_.push_back(0);
        if (all.size() * small_runs > controls_.size()) {
            for (const Index child : part.children) {
                std::size_t& below = level_[static_cast<std::size_t>(child)];
                if (below == 0) append(below = 1, begin_[static_cast<std::size_t>(child)], child);
                level_[parted] = std::max(level_[parted], below);
            }
            append(++level_[parted], index, index);
        }
        result_.parts.push_back(std::move(part));
        return index;
    }

    /// A run to a level counted from one.
    void append(std::size_t level, Index first, Index last) {
        if (result_.levels.size() < level) result_.levels.resize(level);
        result_.levels[level - 1].push_back({first, last + 1});
    }

    /// Control points beside a box that couple with it.
    std::vector<Index> around(const Box& box) const {
        std::vector<Index> reached[GridIndex::most_axes];
        for (std::size_t k = 0; k < GridIndex::most_axes; ++k) {
            const Index n = controls_.length(k);
            const Index reach = k < axes_.size() ? axes_[k].degree() : 0;
            const bool closed = k < axes_.size() && axes_[k].closed();
            for (Index i = 0; i < n; ++i) {
                const Index away = std::max(box.begin[k] - i, i - (box.end[k] - 1));
                const Index back = std::min(i + n - (box.end[k] - 1), box.begin[k] + n - i);
                if (away <= reach || (closed && back <= reach)) reached[k].push_back(i);
            }
        }
        std::vector<Index> result;
        for (const Index a : reached[0])
            for (const Index b : reached[1])
                for (const Index c : reached[2])
                    if (!box.contains({a, b, c, 0})) result.push_back(controls_.at({a, b, c, 0}));
        return result;
    }

    /// Borders as ascending places, and where these are in the parents.
    void order_borders() {
        for (NetDissection::Part& part : result_.parts) {
            for (Index& control : part.border)
                control = result_.place[static_cast<std::size_t>(control)];
            std::ranges::sort(part.border);
        }
        for (const NetDissection::Part& parent : result_.parts)
            for (const Index child : parent.children) {
                NetDissection::Part& part = result_.parts[static_cast<std::size_t>(child)];
                for (const Index place : part.border) {
                    const Index own = place - parent.first;
                    part.in_parent.push_back(
                        own < parent.count
                            ? own
                            : parent.count + (std::ranges::lower_bound(parent.border, place) -
                                              parent.border.begin()));
                }
            }
    }

    const std::vector<KnotVector>& axes_;
    GridIndex controls_;
    NetDissection result_;
    std::vector<Index> begin_;       // of each part the first of those that lead to it
    std::vector<std::size_t> level_; // of each part's run, from one; zero within one
    Index next_ = 0;
};

} // namespace

NetDissection dissected(const std::vector<KnotVector>& axes) {
    return Dissector(axes).run();
}

} // namespace batten
