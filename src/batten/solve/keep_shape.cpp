#include <batten/solve/keep_shape.hpp>

#include <batten/core/distinct.hpp>
#include <batten/shape/polygon.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/nearest_signs.hpp>
#include <batten/solve/schur.hpp>
#include <batten/solve/turn_program.hpp>

#include <algorithm>
#include <limits>

namespace batten {

namespace {

/// Adds the turns of the wrong sign, and their neighbours, to the ascending `watched`.
void watch_wrong(const Turns& turns, const std::vector<int>& signs, std::vector<Index>& watched) {
    const Index n = turns.count();
    for (Index k = 0; k < n; ++k) {
        if (turns.value(k) * signs[static_cast<std::size_t>(k)] > 0) continue;
        for (Index near : {k - 1, k, k + 1})
            if (near >= 0 && near < n) watched.push_back(near);
    }
    watched = distinct(std::move(watched));
}

/// One quadratic program: the best fit's control points moved so that the watched turns, linearised
/// around `around`, have their signs where coordinates are as large as `largest`.
PointSet with_signs(const PointSet& best, const PointSet& around, const std::vector<int>& signs,
                    const std::vector<Index>& watched, const BandedMatrix& gram,
                    const Constraints& held, double largest) {
    constexpr double bent = 1e-7; // of the squared legs: a turn that counts as bent
    const double written = 8 * kept_roundings * std::numeric_limits<double>::epsilon() * largest;
    const Turns turns{around, gram.closure() == Closure::closed};
    std::vector<TurnRow> rows;
    for (const Index k : watched) {
        const auto [a, b, c] = turns.vertices(k);
        const double legs = std::max(turns.legs(k), 1e-300);
        const double scale = signs[static_cast<std::size_t>(k)] / (legs * legs);
        const auto& p = around;
        // gradient of the turn, bilinear in the three points
        TurnRow row{a,
                    {p(b, 1) - p(c, 1), p(c, 0) - p(b, 0), p(c, 1) - p(a, 1), p(a, 0) - p(c, 0),
                     p(a, 1) - p(b, 1), p(b, 0) - p(a, 0)},
                    0};
        const Index at[] = {a, b, c};
        double here = turns.value(k);
        for (std::size_t j = 0; j < 6; ++j) {
            const Index v = at[j / 2];
            const auto d = static_cast<Index>(j % 2);
            here += row.part[j] * (best(v, d) - p(v, d));
            row.part[j] *= scale;
        }
        row.least = std::max(bent, written / legs) - scale * here;
        rows.push_back(row);
    }
    PointSet result = best;
    add_scaled(result, 1, least_moves(gram, rows, held));
    return result;
}

} // namespace

PointSet solve_with_inflections(const NormalSystem& system, const Constraints& given,
                                Index most_inflections) {
    const Constraints constraints =
        given.empty() ? given : with_best_lengths(system, given.independent(system.size()));
    const PointSet best = solve_direct(system, constraints);
    const Closure closure = system.axes()[0].closure();
    const bool closed = closure == Closure::closed;
    const TurnMargin kept(kept_roundings, system.centre());
    if (inflection_count(best, closure, kept) <= most_inflections) return best;
    const double largest = largest_length(uncentred(best, system.centre()));
    const std::vector<int> signs = nearest_signs({best, closed}, most_inflections);
    const BandedMatrix& gram = *system.factors().front();
    PointSet polygon = best;
    std::vector<Index> watched; // turns that had the other sign once
    constexpr int most_programs = 16;
    for (int round = 0; round < most_programs; ++round) {
        watch_wrong({polygon, closed}, signs, watched);
        polygon = with_signs(best, polygon, signs, watched, gram, constraints, largest);
        if (inflection_count(polygon, closure, kept) <= most_inflections) break;
    }
    if (constraints.empty()) return polygon;
    const auto normal = factorize(system);
    return onto_constraints(std::move(polygon), constraints, *normal,
                            SchurComplement(*normal, constraints, system.size()));
}

} // namespace batten
