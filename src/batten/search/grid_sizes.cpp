#include <batten/search/grid_sizes.hpp>

#include <batten/core/vectors.hpp>
#include <batten/search/grid_trials.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/problem/held.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace batten {

namespace {

/// Grows until the tolerance is met; the axis whose growth leaves the smaller error goes first.
bool grow(GridTrials& search, std::vector<Index>& n, const std::vector<Index>& most) {
    double worst = search(n);
    for (int round = 0; round < 200 && worst > 1; ++round) {
        const double factor = worst > 100 ? 1.5 : worst > 4 ? 1.25 : 1.08;
        std::vector<Index> best;
        double best_worst = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < n.size(); ++k) {
            if (n[k] >= most[k]) continue;
            std::vector<Index> longer = n;
            longer[k] =
                std::min(most[k], std::max(n[k] + 1,
                                           static_cast<Index>(static_cast<double>(n[k]) * factor)));
            const double w = search(longer);
            const auto filled = [&](const std::vector<Index>& size) {
                double share = 0;
                for (std::size_t a = 0; a < size.size(); ++a)
                    share = std::max(share,
                                     static_cast<double>(size[a]) / static_cast<double>(most[a]));
                return share;
            };
            if (best.empty() || w < best_worst ||
                (w == best_worst && filled(longer) < filled(best))) {
                best_worst = w;
                best = longer;
            }
        }
        if (best.empty()) return false;
        n = best;
        worst = best_worst;
    }
    return worst <= 1;
}

/// Shrinks each axis by ever smaller steps while the tolerance holds, trading one axis for another
/// at the end.
void shrink(GridTrials& search, std::vector<Index>& n, const std::vector<Index>& least) {
    for (Index step = std::max<Index>(1, *std::max_element(n.begin(), n.end()) / 8); step >= 1;
         step = step == 1 ? 0 : step / 2)
        for (bool any = true; any;) {
            any = false;
            for (std::size_t k = 0; k < n.size(); ++k) {
                std::vector<Index> shorter = n;
                shorter[k] -= step;
                if (shorter[k] >= least[k] && search(shorter) <= 1) {
                    n = shorter;
                    any = true;
                }
            }
        }
    for (bool any = true; any;) { // one more here for two or more fewer there
        any = false;
        for (std::size_t a = 0; a < n.size() && !any; ++a)
            for (std::size_t b = 0; b < n.size() && !any; ++b)
                for (Index more = 1; more <= 3 && !any && a != b; ++more)
                    for (Index fewer = 1; fewer <= 4 && !any; ++fewer) {
                        std::vector<Index> traded = n;
                        traded[a] += more;
                        traded[b] -= fewer;
                        if (traded[b] < least[b] || GridIndex(traded).size() >= GridIndex(n).size())
                            continue;
                        if (search(traded) <= 1) {
                            n = traded;
                            any = true;
                        }
                    }
    }
}

/// Surfaces: other lengths of the first axis, each with the fewest on the second that bisection
/// finds.
void rebalance(GridTrials& search, std::vector<Index>& n, const std::vector<Index>& least,
               const std::vector<Index>& most) {
    if (n.size() != 2) return;
    const std::vector<Index> start = n;
    for (double factor : {0.5, 0.6, 0.7, 0.8, 0.87, 0.93, 0.97, 1.04, 1.1, 1.2, 1.4, 1.7}) {
        const Index first = std::clamp(static_cast<Index>(static_cast<double>(start[0]) * factor),
                                       least[0], most[0]);
        Index missed = least[1] - 1;
        Index met = std::min(most[1] + 1, (GridIndex(n).size() + first - 1) /
                                              first); // no better than what there is
        if (met <= missed + 1 || search({first, met - 1}) > 1) continue;
        --met;
        while (met > missed + 1) {
            const Index middle = (met + missed) / 2;
            (search({first, middle}) <= 1 ? met : missed) = middle;
        }
        n = {first, met};
    }
}

/// Makes each axis shorter by ever smaller steps while the tolerance holds.
void take_off(GridTrials& search, std::vector<Index>& n, const std::vector<Index>& least) {
    for (Index step = std::max<Index>(1, *std::max_element(n.begin(), n.end()) / 32); step >= 1;
         step = step == 1 ? 0 : step / 2)
        for (std::size_t k = 0; k < n.size(); ++k) {
            std::vector<Index> shorter = n;
            shorter[k] -= step;
            if (shorter[k] >= least[k] && search(shorter) <= 1) n = shorter;
        }
}

/// All axes shorter by one factor, the smallest that holds the tolerance, by bisection.
void scale_down(GridTrials& search, std::vector<Index>& n, const std::vector<Index>& least) {
    const std::vector<Index> start = n;
    double missed = 0.7;
    double held = 1;
    for (int round = 0; round < 6; ++round) {
        const double factor = (missed + held) / 2;
        std::vector<Index> shorter;
        for (std::size_t k = 0; k < start.size(); ++k)
            shorter.push_back(std::max(
                least[k], static_cast<Index>(std::lround(factor * static_cast<double>(start[k])))));
        if (search(shorter) <= 1) {
            held = factor;
            n = shorter;
        } else {
            missed = factor;
        }
    }
}

/// The fewest control points per axis: more where a boundary brings knots along.
std::vector<Index> least_size(const GridTask& task) {
    std::vector<Index> result;
    for (std::size_t k = 0; k < task.degree.size(); ++k) {
        const int p = task.degree[k];
        if (task.closures[k] == Closure::closed) {
            result.push_back(2 * p + 1);
            continue;
        }
        const KnotVector plain = knots_around(p, {}, 0, 1);
        result.push_back(std::min(
            task.most[k],
            knots_for_boundaries(plain, static_cast<int>(k), task.hold.boundaries).free_count()));
    }
    return result;
}

} // namespace

BetweenSamples check_reached(const GridTask& task, const Spline& spline, double worst) {
    std::vector<double> reached = task.tolerance;
    scale(reached, std::max(1.0, worst));
    return check_between_grid(spline, task.samples, task.parameters, reached);
}

GridWithin fewest_sizes(const GridTask& task) {
    const auto t = ascending(task.parameters);
    const auto& degree = task.degree;
    const std::vector<Index> least = least_size(task);
    std::vector<Index> n;
    std::optional<GridTrials> best;
    std::vector<std::pair<std::string, Index>> stages;
    for (bool bent : {false, true}) {
        if (bent && task.parameters.is_scattered()) break; // no rows to take differences along
        std::vector<Spread> spreads;
        for (std::size_t k = 0; k < degree.size(); ++k)
            spreads.push_back(!bent || task.closures[k] == Closure::closed ? even_spread(t[k])
                              : task.bends.empty() ? bend_spread(task.samples, t[k], k, degree[k])
                                                   : task.bends[k]);
        GridTrials search(task, std::move(spreads));
        std::vector<Index> size;
        for (std::size_t k = 0; k < degree.size(); ++k)
            size.push_back(std::min(task.most[k], std::max<Index>(least[k], 6)));
        const bool met = grow(search, size, task.most);
        const Index grown = GridIndex(size).size();
        if (search.best.axis_count() == 0 && !search.conflict.empty())
            throw ConstraintConflict(search.conflict);
        if (met) {
            shrink(search, size, least);
            rebalance(search, size, least, task.most);
            shrink(search, size, least);
        }
        const bool better = !best || (met != best->met ? met
                                      : met            ? search.fewest < best->fewest
                                                       : search.best_worst < best->best_worst);
        if (!better) continue;
        best.emplace(std::move(search));
        n = size;
        stages = {{"grown", grown}, {"shrunk", best->fewest}};
    }
    if (best->met && !task.parameters.is_scattered()) {
        best->effort = GridTrials::Effort::equalised;
        scale_down(*best, n, least);
        take_off(*best, n, least);
        stages.emplace_back("equalised", best->fewest);
    }
    return {.spline = std::move(best->best),
            .met = best->met,
            .worst = best->best_worst,
            .stages = std::move(stages)};
}

} // namespace batten
