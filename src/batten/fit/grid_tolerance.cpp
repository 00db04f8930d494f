#include <batten/fit/grid_tolerance.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/fit/held.hpp>
#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/solve/direct.hpp>
#include <batten/system/collocation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace batten {

namespace {

/// How knots are spread over an axis: the accumulated density at the axis's parameters, from 0
/// to 1.
using Spread = std::vector<double>;

/// The parameters along each axis, ascending: a cloud's sorted.
std::vector<std::vector<double>> ascending(const Parameters& parameters) {
    if (!parameters.is_scattered()) return parameters.axes;
    std::vector<std::vector<double>> result(static_cast<std::size_t>(parameters.axis_count()));
    for (Index i = 0; i < parameters.scattered.size(); ++i)
        for (std::size_t k = 0; k < result.size(); ++k)
            result[k].push_back(parameters.scattered(i, static_cast<Index>(k)));
    for (auto& t : result) {
        std::ranges::sort(t);
        t.erase(std::unique(t.begin(), t.end()), t.end());
    }
    return result;
}

/// Density from differences of order p + 1 of the samples along the axis: the largest over all
/// rows, smoothed, to the power 1 / (p + 1).
Spread bend_spread(const Samples& samples, const std::vector<double>& t, std::size_t axis,
                   int degree) {
    const std::vector<Index> shape = samples.shape();
    const Index m = shape[axis];
    Index inner = samples.dim();
    for (std::size_t k = axis + 1; k < shape.size(); ++k) inner *= shape[k];
    const Index outer = samples.size() * samples.dim() / (m * inner);
    std::vector<double> bend(static_cast<std::size_t>(m), 0);
    std::vector<double> column(static_cast<std::size_t>(m));
    for (Index o = 0; o < outer; ++o)
        for (Index c = 0; c < inner; ++c) {
            for (Index j = 0; j < m; ++j)
                column[static_cast<std::size_t>(j)] =
                    samples.points.data()[(o * m + j) * inner + c];
            for (int order = 0; order <= degree; ++order)
                for (Index j = 0; j + order + 1 < m; ++j)
                    column[static_cast<std::size_t>(j)] = column[static_cast<std::size_t>(j + 1)] -
                                                          column[static_cast<std::size_t>(j)];
            for (Index j = 0; j + degree + 1 < m; ++j) {
                double& to = bend[static_cast<std::size_t>(j + (degree + 1) / 2)];
                to = std::max(to, std::abs(column[static_cast<std::size_t>(j)]));
            }
        }
    for (int pass = 0; pass < 6; ++pass) {
        const std::vector<double> before = bend;
        for (std::size_t j = 1; j + 1 < bend.size(); ++j)
            bend[j] = (before[j - 1] + 2 * before[j] + before[j + 1]) / 4;
    }
    const double largest = *std::max_element(bend.begin(), bend.end());
    Spread sum{0};
    for (std::size_t j = 1; j < t.size();
         ++j) // sample distances cancel: differences already hold h^(p+1)
        sum.push_back(sum.back() +
                      std::pow(largest > 0 ? (bend[j - 1] + bend[j]) / (2 * largest) + 1e-4 : 1.0,
                               1.0 / (degree + 1)));
    for (double& s : sum) s /= sum.back();
    return sum;
}

Spread even_spread(const std::vector<double>& t) {
    Spread sum;
    for (double x : t) sum.push_back((x - t.front()) / (t.back() - t.front()));
    return sum;
}

KnotVector knots_by(const Spread& spread, const std::vector<double>& t, int degree, Index n,
                    Closure closure) {
    const Index count = closure == Closure::closed ? n - 1 : n - degree - 1;
    std::vector<double> interior;
    std::size_t j = 1;
    for (Index k = 1; k <= count; ++k) {
        const double wanted = static_cast<double>(k) / static_cast<double>(count + 1);
        while (j + 1 < spread.size() && spread[j] < wanted) ++j;
        const double part = (wanted - spread[j - 1]) / (spread[j] - spread[j - 1]);
        interior.push_back(t[j - 1] + part * (t[j] - t[j - 1]));
    }
    const bool closed = closure == Closure::closed;
    return knots_around(degree, interior, closed ? 0 : t.front(), closed ? 1 : t.back(), closure);
}

/// Fits with given numbers of control points and remembers the best that met the tolerance.
class Search {
  public:
    Search(const GridTask& task, std::vector<Spread> spreads)
        : task_(task), spreads_(std::move(spreads)), ascending_(ascending(task.parameters)) {}

    /// Largest distance over tolerance with n control points per axis; remembered.
    double operator()(const std::vector<Index>& n) {
        if (const auto known = known_.find(n); known != known_.end() && last_size_ != n)
            if (known->second > 1) return known->second;
        last_size_ = n;
        return known_[n] = attempt(n);
    }

    Spline last;
    double last_worst = std::numeric_limits<double>::infinity();
    bool met = false;
    std::string conflict;

  private:
    double attempt(const std::vector<Index>& n) {
        if (task_.cancelled && task_.cancelled()) throw Cancelled("the fit was cancelled");
        std::vector<KnotVector> axes;
        for (std::size_t k = 0; k < n.size(); ++k) {
            axes.push_back(knots_for_boundaries(
                knots_by(spreads_[k], ascending_[k], task_.degree[k], n[k], task_.closures[k]),
                static_cast<int>(k), task_.hold.boundaries));
            if (axes.back().free_count() > n[k]) // the boundaries alone have more
                return std::numeric_limits<double>::infinity();
            if (!task_.parameters.is_scattered() && undetermined(axes.back(), ascending_[k]))
                return std::numeric_limits<double>::infinity();
        }
        try {
            const auto system = assemble(axes, task_.samples, task_.parameters);
            Spline spline = Spline::from_free(axes, uncentred(solve(*system), system->centre()));
            const std::vector<double> d =
                parametric_deviations(spline, task_.samples, task_.parameters);
            double worst = 0;
            for (std::size_t i = 0; i < d.size(); ++i)
                worst = std::max(worst, d[i] / task_.tolerance[i]);
            if (worst <= 1 || !met) {
                last = std::move(spline);
                last_worst = worst;
            }
            met = met || worst <= 1;
            return worst;
        } catch (const SolverError&) {
            return std::numeric_limits<double>::infinity();
        } catch (const ConstraintConflict& error) { // with more control points it may hold
            conflict = error.what();
            return std::numeric_limits<double>::infinity();
        }
    }

    /// Directly on a grid; on a cloud by preconditioned conjugate gradients, which hold still what
    /// no sample reaches.
    PointSet solve(const NormalSystem& system) const {
        if (task_.hold.equalities())
            return solve_direct(
                system, held_constraints(system.axes(), task_.samples, task_.parameters, task_.hold)
                            .centred(system.centre()));
        if (!task_.parameters.is_scattered()) return solve_direct(system);
        PointSet control(system.size(), system.dim());
        ConjugateGradients cg(system, Preconditioner::axes);
        iterate(cg, control, {.max_iterations = 300, .relative_gradient = 1e-9});
        return control;
    }

    const GridTask& task_;
    std::vector<Spread> spreads_;
    std::map<std::vector<Index>, double> known_;
    std::vector<Index> last_size_;
    std::vector<std::vector<double>> ascending_;
};

Index product(const std::vector<Index>& n) {
    Index result = 1;
    for (Index k : n) result *= k;
    return result;
}

/// Grows until the tolerance is met; the axis whose growth leaves the smaller error goes first.
bool grow(Search& search, std::vector<Index>& n, const std::vector<Index>& most) {
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
void shrink(Search& search, std::vector<Index>& n, const std::vector<Index>& least) {
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
                        if (traded[b] < least[b] || product(traded) >= product(n)) continue;
                        if (search(traded) <= 1) {
                            n = traded;
                            any = true;
                        }
                    }
    }
}

/// Surfaces: other lengths of the first axis, each with the fewest on the second that bisection
/// finds.
void rebalance(Search& search, std::vector<Index>& n, const std::vector<Index>& least,
               const std::vector<Index>& most) {
    if (n.size() != 2) return;
    const std::vector<Index> start = n;
    for (double factor : {0.5, 0.6, 0.7, 0.8, 0.87, 0.93, 0.97, 1.04, 1.1, 1.2, 1.4, 1.7}) {
        const Index first = std::clamp(static_cast<Index>(static_cast<double>(start[0]) * factor),
                                       least[0], most[0]);
        Index missed = least[1] - 1;
        Index met =
            std::min(most[1] + 1, (product(n) + first - 1) / first); // no better than what there is
        if (met <= missed + 1 || search({first, met - 1}) > 1) continue;
        --met;
        while (met > missed + 1) {
            const Index middle = (met + missed) / 2;
            (search({first, middle}) <= 1 ? met : missed) = middle;
        }
        n = {first, met};
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

GridWithin few_knots(const GridTask& task) {
    GridWithin best;
    Index fewest = std::numeric_limits<Index>::max();
    const auto t = ascending(task.parameters);
    const auto& degree = task.degree;
    const auto& closures = task.closures;
    for (bool bent : {false, true}) {
        if (bent && task.parameters.is_scattered()) break; // no rows to take differences along
        std::vector<Spread> spreads;
        for (std::size_t k = 0; k < degree.size(); ++k)
            spreads.push_back(bent && closures[k] == Closure::open
                                  ? bend_spread(task.samples, t[k], k, degree[k])
                                  : even_spread(t[k]));
        Search search(task, std::move(spreads));
        const std::vector<Index> least = least_size(task);
        std::vector<Index> n;
        for (std::size_t k = 0; k < degree.size(); ++k)
            n.push_back(std::min(task.most[k], std::max<Index>(least[k], 6)));
        const bool met = grow(search, n, task.most);
        const Index grown = product(n);
        if (search.last.axis_count() == 0 && !search.conflict.empty())
            throw ConstraintConflict(search.conflict);
        if (met) {
            shrink(search, n, least);
            rebalance(search, n, least, task.most);
            shrink(search, n, least);
            search(n);
        }
        if ((met && !best.met) ||
            (met == best.met &&
             (met ? product(n) < fewest : search.last_worst < best.worst || best.stages.empty()))) {
            fewest = product(n);
            best = {search.last, met, search.last_worst, {{"grown", grown}, {"shrunk", fewest}}};
        }
    }
    return best;
}

} // namespace batten
