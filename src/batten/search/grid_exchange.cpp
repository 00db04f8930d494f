#include <batten/search/grid_exchange.hpp>

#include <batten/search/grid_trials.hpp>
#include <batten/search/thinned_grid.hpp>

#include <optional>
#include <utility>

namespace batten {

namespace {

constexpr Index few_enough = 50000;    // samples that are searched by all of them
constexpr Index first_samples = 16000; // to search by
constexpr Index finer = 4;             // times as many where these do not suffice
constexpr Index least_part = 3;        // some of the samples: at most a third

/// The spline within tolerance of all samples, or, fitted to all of them, on its knots.
std::optional<GridFit> within_all(const GridTask& task, const Spline& spline, GridFit& all,
                                  Index& checks) {
    try {
        ++checks;
        GridFit refitted = least_squares(task, spline.axes(), task.samples);
        if (refitted.worst <= 1) return refitted;
    } catch (const SolverError&) { // then the spline itself
    }
    ++checks;
    all = measured(task, spline);
    if (all.worst <= 1) return all;
    return {};
}

/// The search by about so many samples; nothing where these do not suffice.
std::optional<GridWithin> by_some(const GridTask& task, Index wanted, Index& checks) {
    constexpr int most_searches = 6;
    ThinnedGrid some(task, wanted);
    for (int k = 0; k < most_searches && some.size() <= task.samples.size() / least_part; ++k) {
        GridWithin found = fewest_sizes(some.task());
        if (found.spline.axis_count() == 0 || (!found.met && !some.tells_all())) return {};
        found.searched = some.size();
        GridFit all;
        std::optional<GridFit> fit = within_all(task, found.spline, all, checks);
        if (fit || !found.met) {
            if (!fit) fit = std::move(all);
            found.met = fit->worst <= 1;
            found.worst = fit->worst;
            found.spline = std::move(fit->spline);
            return found;
        }
        if (!some.add_offenders(all.ratio)) return {};
    }
    return {};
}

} // namespace

GridWithin sizes_by_exchange(const GridTask& task) {
    const Index m = task.samples.size();
    Index checks = 0;
    if (m > few_enough && !task.hold.equalities())
        for (Index wanted = first_samples; wanted <= m / least_part; wanted *= finer)
            if (auto found = by_some(task, wanted, checks)) {
                found->full_checks = checks;
                return std::move(*found);
            }
    return fewest_sizes(task);
}

} // namespace batten
