#include <batten/solve/factor_search.hpp>

#include <batten/system/roughness.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace batten {

namespace {

double trace(const BandedMatrix& matrix) {
    double sum = 0;
    for (double x : matrix.diagonal()) sum += x;
    return sum;
}

/// The factor that makes the traces of the roughness and of the normal equations alike: between the
/// extremes, and exact in every unit of the parameters that is a power of two.
double balancing_factor(const NormalSystem& system, int order) {
    double rough = 0;
    for (std::size_t k = 0; k < system.axes().size(); ++k) {
        double product = 1;
        for (std::size_t l = 0; l < system.axes().size(); ++l)
            product *= trace(unit_roughness_matrix(system.axes()[l], l == k ? order : 0));
        rough = std::max(rough, product);
    }
    double sum = 0;
    for (double x : system.diagonal()) sum += x;
    return sum / total_weight(system) / rough;
}

} // namespace

double largest_factor(const NormalSystem& system, int order, Solution solution) {
    constexpr double of_entries = 1e10; // of the condition that the roughness's share makes
    constexpr double of_rows = 1e20;    // theirs is the root, their numbers have 19 digits
    const bool product = system.of_grid() || !system.factors().empty();
    const auto axes = product ? static_cast<double>(system.axes().size()) : 1.0;
    return balancing_factor(system, order) *
           (solution == Solution::rows ? of_rows : std::pow(of_entries, 1 / axes));
}

double total_weight(const NormalSystem& system) {
    PointSet ones(system.size(), 1); // B-splines sum to one
    ones.fill(1);
    PointSet image(system.size(), 1);
    system.apply(ones, image);
    double sum = 0;
    for (double x : image.values()) sum += x;
    return sum;
}

FactorSearch::FactorSearch(const NormalSystem& system, const Samples& samples,
                           const Parameters& parameters, int order)
    : quality_(smoothing_quality(system, samples, parameters, order)),
      balance_(balancing_factor(system, order)),
      m_(static_cast<double>(system.sample_count())),
      size_(static_cast<double>(system.size())) {
    for (const KnotVector& axis : system.axes()) polynomials_ *= axis.closed() ? 1 : order;
}

double FactorSearch::factor(double doublings) const {
    return balance_ * std::exp2(doublings);
}

double FactorSearch::doublings(double factor) const {
    return std::log2(factor / balance_);
}

Quality FactorSearch::quality(double doublings) {
    if (const auto found = seen_.find(doublings); found != seen_.end()) return found->second;
    Quality result{std::numeric_limits<double>::infinity(), size_, {}};
    try {
        result = (*quality_)(factor(doublings));
    } catch (const SolverError&) { // too little to hold every control point, or too much
    }
    return seen_[doublings] = result;
}

double FactorSearch::score(double doublings) {
    const Quality q = quality(doublings);
    const double left = 1 - q.trace / m_;
    return left > 0 ? q.squares / m_ / (left * left) : std::numeric_limits<double>::infinity();
}

bool FactorSearch::has_less(double doublings) {
    return quality(doublings).trace < size_ * (1 - (quality_->estimated() ? 0.01 : 1e-4));
}

bool FactorSearch::has_more(double doublings) {
    return quality(doublings).trace > polynomials_ + (quality_->estimated() ? 2 : 1e-3);
}

double FactorSearch::scanned() {
    constexpr int most_steps = 64;
    double best = 0;
    const auto see = [&](double doublings) {
        if (score(doublings) < score(best)) best = doublings;
    };
    for (int k = 1; k <= most_steps && has_less(-step() * (k - 1)); ++k) see(-step() * k);
    for (int k = 1; k <= most_steps && has_more(step() * (k - 1)); ++k) see(step() * k);
    return best;
}

double FactorSearch::descended(double start) {
    double best = start;
    while (has_less(best) && score(best - step()) < score(best)) best -= step();
    if (best == start)
        while (has_more(best) && score(best + step()) < score(best)) best += step();
    return best;
}

double FactorSearch::tilt(double doublings) {
    const Quality q = quality(doublings);
    const double left = m_ - q.trace;
    if (!std::isfinite(q.squares)) return -std::numeric_limits<double>::infinity();
    return std::log(q.squares_growth * left / (-2 * q.trace_growth * q.squares));
}

double FactorSearch::settled(double start) {
    constexpr double level = 0.25;
    constexpr double longest = 64;
    constexpr int most_rounds = 4;
    double at = start;
    double tilted = tilt(at);
    double before = at;
    double tilted_before = tilted;
    for (double step = 2; step <= longest && !(std::abs(tilted) < level); step *= 2) {
        if (!(tilted > 0 ? has_less(at) : has_more(at))) return at;
        before = std::exchange(at, tilted > 0 ? at - step : at + step);
        tilted_before = std::exchange(tilted, tilt(at));
        if ((tilted > 0) != (tilted_before > 0)) break;
    }
    for (int round = 0; round < most_rounds && !(std::abs(tilted) < level); ++round) {
        double next = (at * tilted_before - before * tilted) / (tilted_before - tilted);
        if (!std::isfinite(next)) next = (at + before) / 2;
        const double tilted_next = tilt(next);
        if ((tilted_next > 0) != (tilted > 0)) {
            before = at;
            tilted_before = tilted;
        }
        at = next;
        tilted = tilted_next;
    }
    return at;
}

double FactorSearch::telling(double doublings) {
    constexpr double less = 0.9;
    constexpr int most_steps = 32;
    for (int k = 0; k < most_steps && has_more(doublings) &&
                    !(quality(doublings + step()).trace < less * quality(doublings).trace);
         ++k)
        doublings += step();
    return doublings;
}

double FactorSearch::lowest(double best) {
    const double before = score(best - step());
    const double after = score(best + step());
    const double bend = before - 2 * score(best) + after;
    if (!(bend > 0) || !std::isfinite(bend)) return best;
    const double place = best + step() * (before - after) / (2 * bend);
    return score(place) < score(best) ? place : best;
}

double FactorSearch::levelled(double best) {
    const auto slope = [&](double x) { return score(x + 0.5) - score(x - 0.5); };
    const int most_rounds = quality_->estimated() ? 4 : 40;
    double low = best - step();
    double high = best + step();
    double at_low = slope(low);
    double at_high = slope(high);
    if (!(at_low < 0) || !(at_high > 0) || !std::isfinite(at_low) || !std::isfinite(at_high))
        return best;
    double middle = best;
    int same_side = 0; // of the level place, so many times: below it negative
    for (int round = 0; round < most_rounds; ++round) {
        const double next = (low * at_high - high * at_low) / (at_high - at_low);
        if (next == middle || !(next > low && next < high)) break;
        middle = next;
        const double at = slope(middle);
        if (at == 0) break;
        same_side = at < 0 ? std::min(same_side, 0) - 1 : std::max(same_side, 0) + 1;
        (at < 0 ? low : high) = middle;
        (at < 0 ? at_low : at_high) = at;
        if (same_side < -1) at_high /= 2;
        if (same_side > 1) at_low /= 2;
    }
    return score(middle) <= score(best) ? middle : best;
}

} // namespace batten
