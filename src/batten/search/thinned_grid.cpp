#include <batten/search/thinned_grid.hpp>

#include <batten/core/distinct.hpp>
#include <batten/core/grid_index.hpp>
#include <batten/problem/subset.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace batten {

namespace {

constexpr double nearly = 0.97;           // part of the tolerance: what may break it next
constexpr Index samples_per_control = 16; // so many tell what a control point does

/// The cells of an even partition of a cloud's parameters.
class Cells {
  public:
    Cells(const PointSet& t, Index per_axis)
        : t_(t), per_axis_(per_axis), box_(bounding_box(Points(t))) {}

    Index count() const {
        Index count = 1;
        for (Index k = 0; k < t_.dim(); ++k) count *= per_axis_;
        return count;
    }

    /// The cell of sample i, and how far it is from its middle.
    std::pair<Index, double> of(Index i) const {
        Index cell = 0;
        double away = 0;
        for (Index k = 0; k < t_.dim(); ++k) {
            const double length = box_(1, k) - box_(0, k);
            const double place = length > 0 ? (t_(i, k) - box_(0, k)) / length : 0;
            const double scaled = place * static_cast<double>(per_axis_);
            const Index along = std::min(per_axis_ - 1, static_cast<Index>(scaled));
            const double from_middle = scaled - static_cast<double>(along) - 0.5;
            away += from_middle * from_middle;
            cell = cell * per_axis_ + along;
        }
        return {cell, away};
    }

  private:
    const PointSet& t_;
    Index per_axis_;
    PointSet box_;
};

} // namespace

ThinnedGrid::ThinnedGrid(const GridTask& whole, Index wanted) : whole_(whole) {
    if (whole.parameters.is_scattered())
        pick_from_cells(wanted);
    else
        pick_lines(wanted);
    take();
}

void ThinnedGrid::pick_lines(Index wanted) {
    const std::vector<Index> shape = whole_.samples.shape();
    const double share =
        std::pow(static_cast<double>(wanted) / static_cast<double>(whole_.samples.size()),
                 1 / static_cast<double>(shape.size()));
    for (std::size_t k = 0; k < shape.size(); ++k) {
        const Index least = std::min<Index>(shape[k], 8 * (whole_.degree[k] + 1));
        const Index count =
            std::clamp(static_cast<Index>(std::lround(share * static_cast<double>(shape[k]))),
                       least, shape[k]);
        std::vector<Index> lines;
        for (Index j = 0; j < count; ++j) // symmetric about the middle
            lines.push_back(count > 1 ? (2 * j * (shape[k] - 1) + count - 1) / (2 * (count - 1))
                                      : 0);
        lines_.push_back(distinct(std::move(lines)));
        bends_.push_back(
            bend_spread(whole_.samples, whole_.parameters.axes[k], k, whole_.degree[k]));
    }
}

void ThinnedGrid::pick_from_cells(Index wanted) {
    const PointSet& t = whole_.parameters.scattered;
    const auto per_axis =
        static_cast<Index>(std::pow(static_cast<double>(wanted), 1 / static_cast<double>(t.dim())));
    const Cells cells(t, std::max<Index>(1, per_axis));
    const auto count = static_cast<std::size_t>(cells.count());
    std::vector<Index> nearest(count, -1);
    std::vector<double> least(count, std::numeric_limits<double>::infinity());
    for (Index i = 0; i < t.size(); ++i) {
        const auto [cell, away] = cells.of(i);
        const auto c = static_cast<std::size_t>(cell);
        if (!(away < least[c])) continue;
        least[c] = away;
        nearest[c] = i;
    }
    for (Index i : nearest)
        if (i >= 0) kept_.push_back(i);
    for (Index k = 0; k < t.dim(); ++k) { // the knots reach from the first parameter to the last
        const auto along = [&](Index i) { return t(i, k); };
        Index first = 0;
        Index last = 0;
        for (Index i = 1; i < t.size(); ++i) {
            if (along(i) < along(first)) first = i;
            if (along(i) > along(last)) last = i;
        }
        kept_.push_back(first);
        kept_.push_back(last);
    }
    kept_ = distinct(std::move(kept_));
}

void ThinnedGrid::keep_crossings() {
    std::vector<Index> shape;
    for (const auto& lines : lines_) shape.push_back(static_cast<Index>(lines.size()));
    const GridIndex here(shape);
    const GridIndex there(whole_.samples.grid);
    kept_.clear();
    for (Index i = 0; i < here.size(); ++i) {
        GridIndex::Place place = here.place(i);
        for (std::size_t k = 0; k < lines_.size(); ++k)
            place[k] = lines_[k][static_cast<std::size_t>(place[k])];
        kept_.push_back(there.at(place));
    }
}

void ThinnedGrid::take() {
    const bool grid = !lines_.empty();
    if (grid) keep_crossings();
    const Subset subset = Subset::keeping(kept_, whole_.samples.size());
    samples_ = subset.of(whole_.samples);
    tolerance_ = subset.of(whole_.tolerance);
    parameters_ = grid ? Parameters{} : subset.of(whole_.parameters);
    most_.clear();
    const auto axes = whole_.most.size();
    const double along = std::pow(static_cast<double>(size()), 1 / static_cast<double>(axes));
    const double spacing = std::pow(samples_per_control, 1 / static_cast<double>(axes));
    for (std::size_t k = 0; k < axes; ++k) {
        const double count = grid ? static_cast<double>(lines_[k].size()) : along;
        most_.push_back(std::clamp(static_cast<Index>(count / spacing),
                                   std::min<Index>(whole_.degree[k] + 1, whole_.most[k]),
                                   whole_.most[k]));
    }
    if (!grid) return;
    samples_.grid.clear();
    samples_.order = whole_.samples.order;
    for (std::size_t k = 0; k < axes; ++k) {
        samples_.grid.push_back(static_cast<Index>(lines_[k].size()));
        parameters_.axes.emplace_back();
        for (Index j : lines_[k])
            parameters_.axes[k].push_back(whole_.parameters.axes[k][static_cast<std::size_t>(j)]);
    }
}

bool ThinnedGrid::add_offenders(const std::vector<double>& ratio) {
    const bool any = lines_.empty() ? add_samples(ratio) : add_lines(ratio);
    if (any) take();
    return any;
}

bool ThinnedGrid::add_lines(const std::vector<double>& ratio) {
    const GridIndex all(whole_.samples.grid);
    bool any = false;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        std::vector<double> worst(static_cast<std::size_t>(all.length(k)), 0);
        for (Index i = 0; i < all.size(); ++i) {
            double& of_line = worst[static_cast<std::size_t>(all.place(i)[k])];
            of_line = std::max(of_line, ratio[static_cast<std::size_t>(i)]);
        }
        std::vector<Index> added;
        for (std::size_t j = 0; j + 1 < lines_[k].size(); ++j) {
            const auto from = worst.begin() + lines_[k][j] + 1;
            const auto to = worst.begin() + lines_[k][j + 1];
            const auto at = std::max_element(from, to);
            if (at != to && *at > nearly) added.push_back(at - worst.begin());
        }
        any = any || !added.empty();
        lines_[k].insert(lines_[k].end(), added.begin(), added.end());
        std::ranges::sort(lines_[k]);
    }
    return any;
}

bool ThinnedGrid::add_samples(const std::vector<double>& ratio) {
    constexpr std::size_t most = 500;
    std::vector<Index> worst;
    for (std::size_t i = 0; i < ratio.size(); ++i)
        if (ratio[i] > nearly) worst.push_back(static_cast<Index>(i));
    std::erase_if(worst, [&](Index i) { return std::ranges::binary_search(kept_, i); });
    std::ranges::stable_sort(worst, std::ranges::greater(),
                             [&](Index i) { return ratio[static_cast<std::size_t>(i)]; });
    worst.resize(std::min(worst.size(), most));
    kept_.insert(kept_.end(), worst.begin(), worst.end());
    std::ranges::sort(kept_);
    return !worst.empty();
}

GridTask ThinnedGrid::task() const {
    GridTask task{.samples = samples_,
                  .parameters = parameters_,
                  .tolerance = tolerance_,
                  .degree = whole_.degree,
                  .closures = whole_.closures,
                  .most = most_,
                  .hold = whole_.hold,
                  .cancelled = whole_.cancelled};
    task.between = whole_.between;
    for (std::size_t k = 0; k < lines_.size(); ++k) { // sums up to the lines that are here
        task.bends.emplace_back();
        for (Index j : lines_[k]) task.bends[k].push_back(bends_[k][static_cast<std::size_t>(j)]);
    }
    return task;
}

} // namespace batten
