#include <batten/solve/factor_search.hpp>

#include <batten/system/roughness.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

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

double FactorSearch::scanned() {
    constexpr int most_steps = 64;
    double best = 0;
    const auto see = [&](double doublings) {
        if (score(doublings) < score(best)) best = doublings;
    };
    const double all = size_ * (1 - (quality_->estimated() ? 0.01 : 1e-4));
    const double none = polynomials_ + (quality_->estimated() ? 2 : 1e-3);
    for (int k = 1; k <= most_steps && quality(-step() * (k - 1)).trace < all; ++k)
        see(-step() * k);
    for (int k = 1; k <= most_steps && quality(step() * (k - 1)).trace > none; ++k) see(step() * k);
    return best;
}

double FactorSearch::descended(double start) {
    double best = start;
    for (const double step : {-this->step(), this->step()})
        while (score(best + step) < score(best)) best += step;
    return best;
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
